"""Scenes of a driven shaft alone (table [shaft]): its parameters, the motion of its hub, its load."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, create_model, model_validator

from ..common.errors import InertiaModuleError, SceneError, must_be
from ..interface.models import DRIVEN_SHAFT
from ..interface.variables import LOCAL, OUTPUT, PARAMETER
from ..model import DrivenShaft
from .keys import (
    Duration,
    Strict,
    Tabulated,
    Times,
    fields_of,
    quantity,
    scene_time_warnings,
    validated,
    with_value,
)
from .loads import TorqueLoad
from .schema import Run, repr_of

READABLE = tuple(variable.name for variable in DRIVEN_SHAFT.with_causality(OUTPUT, LOCAL))

Array = NDArray[np.float64]

_Positive = Annotated[float, quantity("1", above=0.0)] | None
_NotNegative = Annotated[float, quantity("1", 0.0)] | None
# Similarity criteria of Stelmashchuk can replace stiffness c and friction f. With T of the drive and the
# driven inertia J4 they are nu^2 = c T^2 / J4 and 2 Pi = f T / J4.
Shaft: type[BaseModel] = create_model(
    "Shaft",
    __base__=Strict,
    __doc__="Parameters of the driven shaft that differ from the defaults.",
    nu=(_Positive, None),
    Pi=(_NotNegative, None),
    **fields_of(list(DRIVEN_SHAFT.with_causality(PARAMETER))),
)


def stepping_speed(kappa: Array, kappa2: float) -> Array:
    """Return the relative speed of Stelmashchuk's law: acceleration to 2, steady motion, deceleration to 0.

    Args:
        kappa: Relative time t/T, shape (n,).
        kappa2: Relative length of the steady phase; each of the other phases has length 1/2.

    Returns:
        Derivative of the relative angle by kappa, shape (n,).
    """
    up, down = np.clip(kappa, 0.0, 0.5), np.clip(kappa - (0.5 + kappa2), 0.0, 0.5)
    # 2 sin^2 is 1 - cos without cancellation. After the end both terms are 2, so the speed is exactly 0.
    return 2.0 * np.sin(np.pi * up) ** 2 - 2.0 * np.sin(np.pi * down) ** 2


class SteppingDrive(Strict):
    """Motion of the hub by Stelmashchuk's law: acceleration in T/2, steady for kappa2 T, deceleration in T/2.

    Attributes:
        T: Duration of acceleration and deceleration together, s.
        kappa2: Length of the steady phase over T.
        angle: Angle of acceleration and deceleration together, rad.
    """

    kind: Literal["stepping"]
    T: Duration
    kappa2: Annotated[float, quantity("1", 0.0)]
    angle: Annotated[float, quantity("rad", above=0.0)]

    def signal(self) -> Callable[[Array], Array]:
        """Return a function from times, s, shape (n,), to the speed of the hub, rad/s, shape (n,)."""
        return lambda times: stepping_speed(times / self.T, self.kappa2) * self.angle / self.T


class HubTable(Tabulated):
    """Speed of the hub over time.

    Attributes:
        time: Points, s.
        hub_speed: Speed at each point, rad/s.
    """

    kind: Literal["table"]
    time: Times
    hub_speed: list[Annotated[float, quantity("rad/s")]]


class ShaftRun(Run):
    """Duration, communication step and recorded outputs of the run.

    Attributes:
        outputs: Names of the recorded outputs.
    """

    outputs: list[str] = Field(
        default=[variable.name for variable in DRIVEN_SHAFT.with_causality(OUTPUT)], min_length=1
    )


class ShaftScene(Strict):
    """A valid scene of the driven shaft; all quantities in SI units.

    Attributes:
        title: Title of the scene.
        description: Description of the scene.
        shaft: Parameters that differ from the defaults.
        drive: Motion of the hub.
        load: Torque on the driven mass.
        run: Duration, communication step and recorded outputs.
    """

    VARIABLES: ClassVar = DRIVEN_SHAFT.by_name

    title: str = "scene"
    description: str = ""
    shaft: Shaft  # type: ignore[valid-type]
    drive: Annotated[SteppingDrive | HubTable, Field(discriminator="kind")]
    load: TorqueLoad = TorqueLoad(kind="torque", torque=0.0)
    run: ShaftRun

    def __repr__(self) -> str:
        return repr_of(self)

    __str__ = __repr__

    def with_keys(self, keys: Mapping[str, object]) -> ShaftScene:
        """Return a copy of the scene with other values, checked again.

        Args:
            keys: Values by dotted key, such as {"shaft.shaft_stiffness": "2 kN.m/rad"}; None removes a key.

        Raises:
            SceneError: The new scene is invalid.
        """
        tables = self.model_dump(exclude_none=True)
        for name, value in keys.items():
            tables = with_value(tables, name.split("."), value)
        return validated(ShaftScene, tables)

    @model_validator(mode="after")
    def _check(self) -> ShaftScene:
        """Reject unknown outputs; the model of the shaft checks all parameters together."""
        self.run.check_outputs(READABLE)
        scene_time_warnings(self, self.run.stop_time)
        parameters = self.parameters()
        try:
            DrivenShaft("plain").start(**parameters)
        except InertiaModuleError as error:
            raise SceneError(f"shaft: {error}") from None
        return self

    def parameters(self) -> dict[str, float]:
        """Return the parameters in the scene file, SI, by name; nu and Pi as stiffness and friction."""
        shaft: BaseModel = self.shaft
        values: dict[str, float] = shaft.model_dump(exclude_none=True)
        inertia = values.get("driven_inertia", DRIVEN_SHAFT.by_name["driven_inertia"].start or 0.0)
        for name, parameter in (("nu", "shaft_stiffness"), ("Pi", "driven_friction")):
            criterion = values.pop(name, None)
            if criterion is None:
                continue
            if parameter in values:
                raise SceneError(f"only one of shaft.{name} and shaft.{parameter} is allowed (got both)")
            if not isinstance(self.drive, SteppingDrive):
                allowed = f"'stepping' with shaft.{name}"
                raise SceneError(must_be("drive.kind", allowed, repr(self.drive.kind)))
            per_time = criterion / self.drive.T
            values[parameter] = inertia * (per_time**2 if name == "nu" else 2.0 * per_time)
        return values
