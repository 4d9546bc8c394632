"""A scene of the driven shaft alone: its parameters, motion of its hub, load. Its table is [shaft]."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, Field, create_model, model_validator

from ..common.errors import Refused, must_be
from ..common.terminal import Progress
from ..contract.models import DRIVEN_SHAFT
from ..contract.variables import LOCAL, OUTPUT, PARAMETER
from ..harness.simulate import communication_points, drive
from ..loops.sources import evaluate
from ..memory import DrivenShaft
from .keys import Duration, SceneError, Strict, Tabulated, Times, fields_of, quantity, scene_time_warnings
from .parts import TorqueLoad
from .run import Quantity, SceneResult, energy
from .schema import Run

_READABLE = tuple(variable.name for variable in DRIVEN_SHAFT.with_causality(OUTPUT, LOCAL))

Array = NDArray[np.float64]

_Positive = Annotated[float, quantity("1", above=0.0)] | None
_NotNegative = Annotated[float, quantity("1", 0.0)] | None
# with criteria of similarity of Stelmashchuk in place of stiffness and friction, which take T of the drive:
# nu^2 = c T^2 / J4, 2 Pi = f T / J4
Shaft: type[BaseModel] = create_model(
    "Shaft",
    __base__=Strict,
    __doc__="Parameters of the driven shaft that differ from the defaults.",
    nu=(_Positive, None),
    Pi=(_NotNegative, None),
    **fields_of(list(DRIVEN_SHAFT.with_causality(PARAMETER))),
)


def stepping_speed(kappa: Array, kappa2: float) -> Array:
    """Derivative of the angle of Stelmashchuk's law by the relative time kappa = t/T: up to 2, steady, down.

    The steady phase is kappa2 long, the others take 1/2 each.
    """
    up, down = np.clip(kappa, 0.0, 0.5), np.clip(kappa - (0.5 + kappa2), 0.0, 0.5)
    # 1 - cos without cancellation; after the end both terms are 2 and their difference is rest
    return 2.0 * np.sin(np.pi * up) ** 2 - 2.0 * np.sin(np.pi * down) ** 2


class SteppingDrive(Strict):
    """The hub by Stelmashchuk's law: up to speed within T/2, steady for kappa2 T, to rest within T/2.

    Attributes:
        T: s. kappa2: relative length of the steady phase. angle: turned in both other phases together, rad.
    """

    kind: Literal["stepping"]
    T: Duration
    kappa2: Annotated[float, quantity("1", 0.0)]
    angle: Annotated[float, quantity("rad", above=0.0)]

    def signal(self) -> Callable[[Array], Array]:
        """Speed of the hub, rad/s, at times, s, shape (n,)."""
        return lambda times: stepping_speed(times / self.T, self.kappa2) * self.angle / self.T


class HubTable(Tabulated):
    """The speed of the hub over time."""

    kind: Literal["table"]
    time: Times
    hub_speed: list[Annotated[float, quantity("rad/s")]]


class ShaftRun(Run):
    """Length of the run, its steps, and the outputs it records."""

    outputs: list[str] = Field(
        default=[one.name for one in DRIVEN_SHAFT.with_causality(OUTPUT)], min_length=1
    )


class ShaftScene(Strict):
    """A scene of the driven shaft, checked; all quantities in SI units.

    Attributes:
        title, description: for people. shaft: parameters that differ from the defaults.
        drive, load: motion of the hub and torque on the driven mass. run: how it is simulated.
    """

    VARIABLES: ClassVar = DRIVEN_SHAFT.by_name

    title: str = "scene"
    description: str = ""
    shaft: Shaft  # type: ignore[valid-type]
    drive: Annotated[SteppingDrive | HubTable, Field(discriminator="kind")]
    load: TorqueLoad = TorqueLoad(kind="torque", torque=0.0)
    run: ShaftRun

    @model_validator(mode="after")
    def _check(self) -> ShaftScene:
        """Refuse unknown outputs; the shaft itself looks at all parameters together."""
        self.run.check_outputs(_READABLE)
        scene_time_warnings(self, self.run.stop_time)
        parameters = self.parameters()
        try:
            DrivenShaft("plain").start(**parameters)
        except Refused as error:
            raise SceneError(f"shaft: {error}") from None
        return self

    def parameters(self) -> dict[str, float]:
        """The parameters that the scene gives, as numbers; nu and Pi as stiffness and friction."""
        given: BaseModel = self.shaft
        values: dict[str, float] = given.model_dump(exclude_none=True)
        inertia = values.get("driven_inertia", DRIVEN_SHAFT.by_name["driven_inertia"].start or 0.0)
        for name, stands_for in (("nu", "shaft_stiffness"), ("Pi", "driven_friction")):
            criterion = values.pop(name, None)
            if criterion is None:
                continue
            if stands_for in values:
                raise SceneError(f"only one of shaft.{name} and shaft.{stands_for} is allowed (got both)")
            if not isinstance(self.drive, SteppingDrive):
                allowed = f"'stepping' with shaft.{name}"
                raise SceneError(must_be("drive.kind", allowed, repr(self.drive.kind)))
            per_time = criterion / self.drive.T
            values[stands_for] = inertia * (per_time**2 if name == "nu" else 2.0 * per_time)
        return values


def run_shaft_scene(scene: ShaftScene, fmu_path: Path | str, progress: Progress | None = None) -> SceneResult:
    """Run a scene with an FMU of the driven shaft; all else as of run_scene."""
    times = communication_points(scene.run.stop_time, scene.run.communication_step)
    torque = scene.load.one_signal()
    inputs: dict[str, ArrayLike] = {
        "time": times,
        "hub_speed": scene.drive.signal()(times),
        "load_torque": [evaluate(torque, at) for at in times],
    }
    run, values, began = scene.run, scene.parameters(), time.perf_counter()
    record = drive(
        fmu_path, inputs, run.stop_time, run.communication_step, _READABLE, values, progress=progress
    )
    wall_time, simulated = time.perf_counter() - began, float(record.time[-1])
    names = ("omega_out", "driven_acceleration", "shaft_torque", "twist")
    peaks = {name: float(np.abs(record[name]).max()) for name in names}
    quantities = {
        "simulated_time": Quantity(simulated, "s"),
        **{f"{name}_peak": Quantity(peak, record.units[name]) for name, peak in peaks.items()},
        **energy(record),
        "wall_time": Quantity(wall_time, "s"),
        "real_time_factor": Quantity(simulated / wall_time, ""),
    }
    doubts = tuple(scene_time_warnings(scene, run.stop_time))
    return SceneResult(scene=scene, record=record, quantities=quantities, warnings=doubts)
