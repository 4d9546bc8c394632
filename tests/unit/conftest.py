import pytest
from scenes import SCENES


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    """Return scene R1 of the bevel layout, or the planar scene."""
    return SCENES[request.param]
