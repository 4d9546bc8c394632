"""Schema of a scene: mechanism, drive, load, controller, freewheel limits, accuracy and run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, Field, create_model, model_validator

from .. import driveline
from ..common.errors import InertiaModuleError, SceneError, must_be, unknown
from ..driveline.closed_loop import PLANT_INPUTS
from ..driveline.connection import Environment
from ..driveline.cycles import Cycle
from ..driveline.sources import Signal, Sources
from ..fmi.simulate import check_number_of_steps, whole_steps
from ..interface import variables
from ..interface.variables import BY_NAME, with_causality
from ..kernel.codes import DRIVE_TORQUE, ELASTIC
from ..model import Module
from .controllers import Controller, PiController, PiTorqueController
from .drives import Drive, EngineDrive
from .keys import (
    AUTO,
    Duration,
    Keys,
    Strict,
    by_dotted_key,
    fields_of,
    in_range,
    quantity,
    scene_time_warnings,
    validated,
    with_value,
)
from .loads import Load
from .satellite import Satellite

# The parameter tolerance is in the table [accuracy].
Mechanism: type[BaseModel] = create_model(
    "Mechanism",
    __base__=Strict,
    __doc__="Parameters of the module that differ from the defaults (reference case R1).",
    **fields_of([row for row in with_causality(variables.PARAMETER) if row.name != "tolerance"]),
    satellite=(Satellite | None, None),
)


def is_elastic(values: Mapping[str, float]) -> bool:
    """Return True if parameters describe an elastic output.

    Args:
        values: Parameters, SI, by name.
    """
    return any(BY_NAME[name].group == variables.Group.ELASTIC for name in values)


def at_fidelity(values: Mapping[str, float], fidelity: float) -> dict[str, float]:
    """Return parameters for another fidelity; unless it is elastic, the driven mass is rigid with the hub.

    Args:
        values: Parameters, SI, by name.
        fidelity: Number of the fidelity level.
    """
    new_values = {**values, "fidelity": float(fidelity)}
    if fidelity != ELASTIC and is_elastic(values):
        complete = {**variables.default_parameters(), **values}
        new_values["output_inertia"] = complete["output_inertia"] + complete["driven_inertia"]
    return new_values


class Accuracy(Strict):
    """Accuracy of the integration or, with fidelity 'auto', of the outputs.

    Attributes:
        tolerance: Tolerance of the integration; None for the default of the module (1e-6).
        error: Allowed error of the recorded outputs, relative to the maximum magnitude of each.
        window: Averaging time of the outputs before they are compared, s.
    """

    tolerance: Annotated[float, in_range(BY_NAME["tolerance"])] | None = None
    error: Annotated[float, quantity("1", maximum=1.0, above=0.0)] | None = None
    window: Duration = 1.0


class FreewheelLimits(Strict):
    """Limits of a freewheel from its data sheet; None without a limit.

    Attributes:
        indexing_frequency: Maximum engagement frequency of its sprags, Hz.
        torque: Maximum torque, N.m.
        slip: Maximum overrunning speed, rad/s.
        stiffness: Stiffness of the locked freewheel, N.m/rad, to estimate the torque of impacts.
    """

    indexing_frequency: Annotated[float, quantity("Hz", above=0.0)] | None = None
    torque: Annotated[float, quantity("N.m", above=0.0)] | None = None
    slip: Annotated[float, quantity("rad/s", above=0.0)] | None = None
    stiffness: Annotated[float, quantity("N.m/rad", above=0.0)] | None = None


class Freewheels(FreewheelLimits):
    """Limits of both freewheels; the tables of one freewheel replace them for this freewheel.

    Attributes:
        housing: Limits of the housing freewheel.
        output: Limits of the output freewheel.
    """

    housing: FreewheelLimits = FreewheelLimits()
    output: FreewheelLimits = FreewheelLimits()

    def of(self, key: str) -> dict[str, float]:
        """Return the limits of one kind by freewheel.

        Args:
            key: Kind of limit, a field of FreewheelLimits.
        """
        tables = {"housing": self.housing, "output": self.output}
        limits = {name: getattr(table, key) or getattr(self, key) for name, table in tables.items()}
        return {name: limit for name, limit in limits.items() if limit is not None}

    def limits(self) -> dict[str, float]:
        """Return the limits in the scene, by the metric of the summary that they limit."""
        numbers = {
            "indexing_frequency": "engagement_frequency_maximum",
            "torque": "torque_peak",
            "slip": "slip_peak",
        }
        return {
            f"{name}_{number}": limit
            for key, number in numbers.items()
            for name, limit in self.of(key).items()
        }


class Run(Strict):
    """Duration, communication step and recorded outputs of the run.

    Attributes:
        stop_time: Duration, s; a multiple of the communication step.
        communication_step: Communication step, s.
        outputs: Names of the recorded outputs.
    """

    stop_time: Duration
    communication_step: Annotated[float, quantity("s", maximum=variables.LARGEST_STEP, above=0.0)]
    outputs: list[str] = Field(default=[row.name for row in with_causality(variables.OUTPUT)], min_length=1)

    def check_outputs(self, names: Sequence[str]) -> None:
        """Reject an unknown output.

        Args:
            names: Names of all outputs of the FMU and of the loop.

        Raises:
            SceneError: An output is not among the names.
        """
        for name in self.outputs:
            if name not in names:
                raise SceneError(f"run.outputs: {unknown('output', name, names)}")

    @model_validator(mode="after")
    def _whole_steps(self) -> Run:
        check_number_of_steps(self.stop_time, self.communication_step, "run.communication_step")
        if not whole_steps(self.stop_time, self.communication_step):
            allowed = f"a whole multiple of run.communication_step = {self.communication_step:g} s"
            raise SceneError(must_be("run.stop_time", allowed, f"{self.stop_time:g} s"))
        return self


def repr_of(scene: Any) -> str:
    """Return a line that describes a scene of a module or of a driven shaft, for __repr__.

    Args:
        scene: The scene.
    """
    run, kinds = scene.run, f"drive {scene.drive.kind}, load {scene.load.kind}"
    times = f"{run.stop_time:g} s in steps of {run.communication_step:g} s"
    return f"{type(scene).__name__}({scene.title!r}, {kinds}, {times})"


class Scene(Strict):
    """A valid scene of a module; all quantities in SI units.

    Attributes:
        title: Title of the scene.
        description: Description of the scene.
        mechanism: Parameters of the module that differ from the defaults.
        drive: Drive of link 1.
        load: Load of the output shaft.
        controller: Controller of the drive, or None.
        freewheels: Limits of the freewheels.
        accuracy: Tolerance of the integration, or allowed error of the outputs.
        run: Duration, communication step and recorded outputs.
    """

    VARIABLES: ClassVar = BY_NAME

    title: str = "scene"
    description: str = ""
    mechanism: Mechanism = Field(default_factory=Mechanism)  # type: ignore[valid-type]
    drive: Drive
    load: Load
    controller: Controller | None = None
    freewheels: Freewheels = Field(default_factory=Freewheels)
    accuracy: Accuracy = Field(default_factory=Accuracy)
    run: Run

    def __repr__(self) -> str:
        return repr_of(self)

    __str__ = __repr__

    @property
    def measured(self) -> str:
        """Return the name of the controlled speed."""
        return "vehicle_speed" if self.load.kind == "vehicle" else "omega_out"

    @property
    def chooses_fidelity(self) -> bool:
        """Return True if the fidelity is 'auto', which measurements replace by a level."""
        return bool(vars(self.mechanism)["fidelity"] == AUTO)

    @property
    def cycle(self) -> Cycle | None:
        """Return the driving cycle of a vehicle, published or from a table of the scene; None without one."""
        if self.controller is None or self.load.kind != "vehicle":
            return None
        return self.controller.reference.driving_cycle()

    @property
    def signal_units(self) -> dict[str, str]:
        """Return the units of signals that depend on the scene, by name."""
        return {"reference": "m/s" if self.load.kind == "vehicle" else "rad/s"}

    def drive_torque_limit(self, omega1: float) -> float | None:
        """Return the maximum torque of the drive at a speed, N.m; None for a drive without a torque limit.

        Args:
            omega1: Speed of link 1, rad/s.
        """
        if isinstance(self.drive, EngineDrive):
            return float(self.drive.torque_map().limits(abs(omega1))[1])
        return self.controller.maximum if isinstance(self.controller, PiTorqueController) else None

    @cached_property
    def built_load(self) -> driveline.Load:
        """Return the load as a system."""
        # Two freewheels prevent the output shaft from rotating backward.
        prevents_reverse = all(
            self.explicit_parameters.get(name, 1.0) for name in ("housing_freewheel", "output_freewheel")
        )
        start_speed = self.explicit_parameters.get("omega_out_start", 0.0)
        return self.load.build(self.run.communication_step, prevents_reverse, start_speed)

    @cached_property
    def tables(self) -> dict[str, object]:
        """Return all values in the scene file as nested tables, in SI units."""
        return self.model_dump(exclude_none=True)

    @cached_property
    def surroundings(self) -> Environment:
        """Return the environment of the FMU: load, drive and controller as one connected system."""
        return driveline.connect(list(self.systems()))

    def systems(self) -> Iterator[Environment]:
        """Yield load, controller and drive as systems to connect."""
        step = self.run.communication_step
        load = self.built_load.system
        yield load
        if self.controller is not None:
            yield from self.controller.build(step, self.measured)
        yield from self.drive.systems(step)
        has_brake = self.controller is not None and self.controller.brake is not None
        if "brake_force" in load.input_labels and not has_brake:
            yield Sources({"brake_force": 0.0}, step)

    @property
    def prescribed(self) -> dict[str, Signal]:
        """Return the inputs of the module that do not depend on its state, by name."""
        sources = [system.signals for system in self.systems() if isinstance(system, Sources)]
        return {name: signals[name] for signals in sources for name in PLANT_INPUTS if name in signals}

    def replaced(self, **tables: Mapping[str, object]) -> Scene:
        """Return a copy of the scene with other values, checked again.

        Args:
            tables: Values by table and key, such as run={"stop_time": 2.0}; None removes a key.

        Raises:
            SceneError: The new scene is invalid.
        """
        return self.with_keys(
            {f"{table}.{key}": value for table, keys in tables.items() for key, value in keys.items()}
        )

    def with_keys(self, keys: Keys) -> Scene:
        """Return a copy of the scene with other values, checked again.

        Args:
            keys: Values by dotted key or by the name of a parameter of the mechanism, such as
                {"imbalance_mass": 2, "load.torque": "8 N.m"}; None removes a key.

        Raises:
            SceneError: The new scene is invalid.
        """
        keys = by_dotted_key(keys)
        names = {name.partition(".")[0] for name in keys}
        # The units of a controller depend on the load.
        names |= {"controller"} if "load" in names else set()
        # The table of a design specification has more fields than a scene.
        fields = self.model_fields_set & Scene.model_fields.keys()
        data = {name: self.tables.get(name) if name in names else getattr(self, name) for name in fields}
        for name, value in keys.items():
            data = with_value(data, name.split("."), value)
        return validated(Scene, data)

    @cached_property
    def explicit_parameters(self) -> dict[str, float]:
        """Return the parameters of the mechanism in the scene file, SI, by name, without fidelity 'auto'."""
        values = {name: value for name, value in vars(self.mechanism).items() if name != "satellite"}
        return {name: value for name, value in values.items() if value not in (None, AUTO)}

    @cached_property
    def following(self) -> dict[str, float]:
        """Return the parameters that are calculated from dimensions and materials of the satellites."""
        satellite: Satellite | None = vars(self.mechanism)["satellite"]
        return {} if satellite is None else satellite.parameters(self.explicit_parameters)

    def with_fidelity(self, fidelity: str, error: float | None = None) -> Scene:
        """Return a copy of the scene with a fidelity.

        At other levels than elastic the driven mass of an elastic output is rigid with the hub.

        Args:
            fidelity: Name of the level, or 'auto'.
            error: Allowed relative error of the outputs, for 'auto'; None keeps the value of the scene.

        Raises:
            SceneError: The new scene is invalid.
        """
        accuracy = {} if error is None else {"error": error}
        if fidelity == AUTO:
            removed = {"method": None, "max_step": None}
            return self.replaced(
                mechanism={"fidelity": AUTO, **removed}, accuracy={**accuracy, "tolerance": None}
            )
        scene = self.replaced(mechanism={"fidelity": fidelity}, accuracy=accuracy)
        return scene.replaced(
            mechanism=at_fidelity(scene.explicit_parameters, scene.explicit_parameters["fidelity"])
        )

    @property
    def _own_inertia(self) -> tuple[str, float]:
        """Return name and value, kg.m2, of the inertia of link 3, or of the driven mass if elastic."""
        name = "driven_inertia" if self.explicit_parameters.get("fidelity") == ELASTIC else "output_inertia"
        return name, self.explicit_parameters.get(name, BY_NAME[name].start or 0.0)

    def parameters(self) -> dict[str, float]:
        """Return the parameters for the FMU, SI, by name, including drive and rigid load."""
        values = self.drive.driven({**self.explicit_parameters, **self.following})
        rigid = self.built_load.rigid_inertia
        name, own = self._own_inertia
        return {**values, name: own + rigid} if rigid else values

    @model_validator(mode="after")
    def _check(self) -> Scene:
        """Reject tables that contradict each other; the module itself checks all parameters together."""
        self._check_drive()
        self._check_choice()
        self._check_vehicle()
        self.run.check_outputs([*variables.COMPUTED, *self.surroundings.output_labels])
        scene_time_warnings(self, self.run.stop_time)
        load, parameters = self.built_load, self.parameters()
        try:
            load.check_step(self._own_inertia[1])
            self.drive.check_step(self.run.communication_step, parameters.get("input_inertia", 0.0))
        except ValueError as error:
            raise SceneError(f"run.communication_step: {error}") from None
        try:
            Module("plain").check(**parameters)
        except InertiaModuleError as error:
            raise SceneError(f"mechanism: {error}") from None
        return self

    def _check_drive(self) -> None:
        """Reject a drive that contradicts [controller] or mechanism.drive."""
        kind, mode, explicit_mode = self.drive.kind, self.drive.mode, self.explicit_parameters.get("drive")
        if self.controller is None and kind in (PiController.DRIVE, PiTorqueController.DRIVE):
            raise SceneError(f"drive.kind = {kind!r} requires a table [controller]")
        if self.controller is not None and kind != self.controller.DRIVE:
            allowed = f"{self.controller.DRIVE!r} with controller.kind = {self.controller.kind!r}"
            raise SceneError(must_be("drive.kind", allowed, repr(kind)))
        if explicit_mode is not None and explicit_mode != mode:
            names = {number: name for name, number, _ in variables.ENUMERATIONS["Drive"]}
            other = "speed" if mode == DRIVE_TORQUE else "torque"
            allowed = f"{names[mode]!r} with drive.kind = {kind!r}"
            demand = must_be("mechanism.drive", allowed, repr(names[int(explicit_mode)]))
            raise SceneError(f"{demand}. Omit it, or use a drive.kind that prescribes a {other}.")

    def _check_choice(self) -> None:
        """Reject fidelity 'auto' without an allowed error, or with parameters that it sets."""
        if not self.chooses_fidelity:
            return
        if self.accuracy.error is None:
            raise SceneError("mechanism.fidelity = 'auto' requires accuracy.error, e.g. '1 %'")
        automatic = {
            f"mechanism.{name}": self.explicit_parameters.get(name) for name in ("method", "max_step")
        }
        for name, value in {**automatic, "accuracy.tolerance": self.accuracy.tolerance}.items():
            if value is not None:
                raise SceneError(
                    f"{name} is not allowed with mechanism.fidelity = 'auto' (got {value:g})."
                    " It follows from accuracy.error."
                )

    def _check_vehicle(self) -> None:
        """Reject another load with a controller that requires a vehicle."""
        if self.controller is None or self.load.kind == "vehicle":
            return
        cycle = self.controller.reference.kind == "cycle"
        brake = self.controller.brake is not None
        for key, is_present in (("reference.kind = 'cycle'", cycle), ("brake", brake)):
            if is_present:
                allowed = f"'vehicle' with controller.{key}"
                raise SceneError(must_be("load.kind", allowed, repr(self.load.kind)))
