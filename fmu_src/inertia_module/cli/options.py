"""Options that several commands share, and the conversion of their values."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from ..common.errors import must_be, unknown
from ..common.units import factor_between, number_of, split_quantity
from .messages import print_to_stderr

# types of option values; None without the option
Text = str | None
Texts = list[str] | None
File = Path | None


def option(text: str, metavar: str | None = None, *names: str, **more: Any) -> Any:
    """Declare an option of a command.

    Args:
        text: Help text.
        metavar: Placeholder of the value; None for a flag.
        names: Names of the option if they differ from the parameter.
        more: More arguments of typer.Option.
    """
    return typer.Option(*names, metavar=metavar, help=text, **more)


def enumeration(text: str, names: Sequence[str], *flags: str) -> Any:
    """Declare an option whose value is one of some names; the shell completes the names.

    Args:
        text: Help text.
        names: Allowed values.
        flags: Names of the option if they differ from the parameter.
    """
    return option(text, "|".join(names), *flags, autocompletion=lambda: list(names))


def check_choice(kind: str, name: str | None, names: Sequence[str]) -> None:
    """Check that the value of an option is one of its names.

    Args:
        kind: Noun for the names, such as "fidelity".
        name: Value; None without the option.
        names: Allowed values.

    Raises:
        ValueError: The value is not one of the names.
    """
    if name is not None and name not in names:
        raise ValueError(unknown(kind, name, names))


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="Scene file (TOML).")]
OutputFolder = Annotated[File, option("Output folder (created if missing).", "DIR", "--output", "-o")]
FmuToRun = Annotated[File, option("FMU to use instead of the bundled one.", "FILE.fmu")]
Keys = Annotated[
    Texts,
    option("Override a scene value, e.g. load.torque='8 N.m'; may be repeated.", "KEY=VALUE", "--set"),
]
# names of the fidelity levels, and "auto", for which the package chooses a level
FIDELITIES = ("kinematic", "averaged", "rigid", "elastic", "auto")

Json = Annotated[bool, option("Print the result as JSON.", None, "--json")]
Scheduler = Annotated[Text, option("Address of a Dask scheduler, e.g. tcp://host:8786.", "ADDRESS")]
Workers = Annotated[
    int | None, option("Number of local worker processes (default: one per core).", "N", min=1)
]


def quantity_of(option: str, text: str | None, unit: str, **limits: float) -> float | None:
    """Convert the value of an option, such as "2 s", to SI and check its range.

    Args:
        option: Name of the option in messages.
        text: Value; None without the option.
        unit: SI unit, "1" for none.
        limits: Limits, as in scene.keys.checked.

    Raises:
        ValueError: The value is not allowed.
    """
    from ..scene.keys import checked

    try:
        return None if text is None else checked(text, unit, **limits)
    except ValueError as error:
        raise ValueError(f"{option} {error}") from None


def values_of(keys: list[str] | None) -> dict[str, object]:
    """Return the values of the options --set by dotted key.

    Args:
        keys: Texts KEY=VALUE.

    Raises:
        SceneError: A text is not of this form.
    """
    from ..scene.keys import keys_from_options

    return keys_from_options(keys)


def speed_of(text: str) -> float:
    """Convert the option --speed, such as "3000 rpm", to rad/s; negative for backward rotation.

    Args:
        text: Value of the option.

    Raises:
        ValueError: The value is no speed, is 0, or exceeds the maximum.
    """
    from ..interface.variables import LARGEST_SPEED

    allowed = f"non-zero and at most {LARGEST_SPEED:g} rad/s, e.g. '3000 rpm'"
    message = must_be("--speed", allowed, repr(text))
    try:
        omega1 = number_of(text, "rad/s")
    except ValueError as error:
        raise ValueError(f"{message}: {error}") from None
    if not 0.0 < abs(omega1) <= LARGEST_SPEED:
        raise ValueError(message)
    if not split_quantity(text)[1]:
        print_to_stderr(f"warning: --speed {text} has no unit; rad/s is used: {speed_text(omega1)}")
    return omega1


def speed_text(omega1: float) -> str:
    """Return a speed as text, in rad/s and rpm.

    Args:
        omega1: Speed, rad/s.
    """
    return f"{omega1:.5g} rad/s ({omega1 / factor_between('rpm', 'rad/s'):.5g} rpm)"
