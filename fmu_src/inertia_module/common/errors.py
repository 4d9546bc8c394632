"""The error of the package, of which all others are kinds, and the sentence it says."""


class Refused(ValueError):
    """What cannot be done: the message names the value and what is allowed. Nothing has changed."""


def must_be(name: str, allowed: str, value: float | str) -> str:
    """The sentence for a bad value: "tolerance must be between 0 and 1, is 7".

    Args:
        name: of the value. allowed: what follows "must be". value: a number, or text that stands for it.
    """
    return f"{name} must be {allowed}, is {value if isinstance(value, str) else format(value, '.16g')}"


class DriveError(Refused):
    """The FMU cannot be loaded, or refused parameters, inputs or a step: its own message."""
