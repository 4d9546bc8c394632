"""Rejections: messages of invalid values and inconsistent parameters, and messages of an action."""

import re
import tomllib
from pathlib import Path

from inertia_module.common.errors import Refused
from inertia_module.model import ModelInstance

# rows by subject: input, and words of the message
REFUSED = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def sentence(variable, value):
    """Return the whole message of an invalid value, from the table of variables."""
    return f"{variable.name} must be {variable.allowed} (got {value:.16g})"


def records(action):
    """Values, state and outputs of the model in memory that an action is of, where it has started."""
    owner = getattr(action, "__self__", None)
    if not (isinstance(owner, ModelInstance) and owner.started):
        return []
    return [bytes(part) for part in (owner.parameters, owner.inputs, owner.state, owner.outputs)]


def refusal(action, *arguments, **values):
    """Return the message of a rejected action, or "" if it is accepted; a started model must not change."""
    message, before = "", records(action)
    try:
        action(*arguments, **values)
    except Refused as error:
        message = str(error)
        assert records(action) == before, f"{message}: something has changed"
    assert "\n" not in message
    return message


def assert_refused(words, action, *arguments, **values):
    """Check that an action is rejected with a line that matches a regular expression."""
    message = refusal(action, *arguments, **values)
    assert re.search(words, message), message
