"""The error of the package: whatever it refuses, it says so by this one or by a kind of it."""


class Refused(ValueError):
    """What cannot be done: the message names the value and what is allowed. Nothing has changed."""


class DriveError(Refused):
    """The FMU cannot be loaded, or refused parameters, inputs or a step: its own message."""
