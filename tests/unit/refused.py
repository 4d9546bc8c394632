"""Refusals: sentences on values and on parameters that do not go together; those of an action."""

import re
import tomllib
from pathlib import Path

from inertia_module.common.errors import InertiaModuleError
from inertia_module.model import ModelInstance

# by what is refused, rows of what is given and words of the sentence
REFUSED = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def sentence(variable, value):
    """The whole refusal of a value, from the table of variables."""
    return f"{variable.name} must be {variable.allowed} (got {value:.16g})"


def records(action):
    """Values, state and outputs of the model in memory that an action is of, where it has started."""
    owner = getattr(action, "__self__", None)
    if not (isinstance(owner, ModelInstance) and owner.started):
        return []
    return [bytes(part) for part in (owner.parameters, owner.inputs, owner.state, owner.outputs)]


def refusal(action, *arguments, **values):
    """The line that an action is refused with; "" where it is not. A model that has started is as it was."""
    said, before = "", records(action)
    try:
        action(*arguments, **values)
    except InertiaModuleError as error:
        said = str(error)
        assert records(action) == before, f"{said}: something has changed"
    assert "\n" not in said
    return said


def assert_refused(words, action, *arguments, **values):
    """That an action is refused in a line with these words, a regular expression."""
    said = refusal(action, *arguments, **values)
    assert re.search(words, said), said
