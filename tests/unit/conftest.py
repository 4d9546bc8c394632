import pytest
from scenes import SCENES


@pytest.fixture(scope="module", params=SCENES)
def scene(request):
    """Scene R1 of the bevel layout, and the planar one."""
    return SCENES[request.param]
