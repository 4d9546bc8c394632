"""Checks of errors: messages about values, about contradictory parameters, and about actions."""

import re
import tomllib
from pathlib import Path

from inertia_module.common.errors import InertiaModuleError
from inertia_module.model import ModelInstance

# Rows of values and words of the message, by kind of error.
REJECTED = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def sentence(variable, value):
    """Return the complete message for a bad value, from the table of variables."""
    return f"{variable.name} must be {variable.allowed} (got {value:.16g})"


def records(action):
    """Return values, state and outputs of the started model in memory that owns an action."""
    owner = getattr(action, "__self__", None)
    if not (isinstance(owner, ModelInstance) and owner.started):
        return []
    return [bytes(part) for part in (owner.parameters, owner.inputs, owner.state, owner.outputs)]


def rejection(action, *arguments, **values):
    """Return the message of a rejected action, "" if it succeeds. A started model must not change."""
    message, before = "", records(action)
    try:
        action(*arguments, **values)
    except InertiaModuleError as error:
        message = str(error)
        assert records(action) == before, f"{message}: something has changed"
    assert "\n" not in message
    return message


def assert_rejected(pattern, action, *arguments, **values):
    """Check that an action fails with a line that matches a regular expression."""
    message = rejection(action, *arguments, **values)
    assert re.search(pattern, message), message
