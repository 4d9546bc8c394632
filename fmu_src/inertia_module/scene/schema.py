"""A scene: which mechanism, drive, load and controller, which outputs, how accurate, how long."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, Field, create_model, model_validator

from .. import loops
from ..common.errors import Refused, must_be, unknown
from ..contract import variables
from ..contract.variables import BY_NAME, with_causality
from ..harness.simulate import check_number_of_steps, whole_steps
from ..kernel.codes import DRIVE_TORQUE, ELASTIC
from ..loops.closed_loop import PLANT_INPUTS
from ..loops.cycles import Cycle
from ..loops.sources import Signal, Sources
from ..memory import Module
from .keys import (
    AUTO,
    Duration,
    SceneError,
    Strict,
    changed,
    fields_of,
    in_range,
    quantity,
    scene_time_warnings,
    validated,
)
from .parts import Controller, Drive, EngineDrive, Load, PiController, PiTorqueController
from .satellite import Satellite

# tolerance has a table of its own: [accuracy]
Mechanism: type[BaseModel] = create_model(
    "Mechanism",
    __base__=Strict,
    __doc__="Parameters of the module that differ from the defaults (reference case R1).",
    **fields_of([one for one in with_causality(variables.PARAMETER) if one.name != "tolerance"]),
    satellite=(Satellite | None, None),
)


def is_elastic(values: Mapping[str, float]) -> bool:
    """Tell whether parameters describe an elastic output."""
    return any(BY_NAME[name].group == variables.Group.ELASTIC for name in values)


def at_fidelity(values: Mapping[str, float], fidelity: float) -> dict[str, float]:
    """Parameters for another fidelity: without an elastic output the driven mass is rigid with the hub."""
    changed = {**values, "fidelity": float(fidelity)}
    if fidelity != ELASTIC and is_elastic(values):
        known = {**variables.default_parameters(), **values}
        changed["output_inertia"] = known["output_inertia"] + known["driven_inertia"]
    return changed


class Accuracy(Strict):
    """Accuracy of the integration or, where the fidelity is to be chosen, of the outputs.

    Attributes:
        tolerance: of the integration; None for that of the module (1e-6).
        error: allowed in the wanted outputs, relative to the largest magnitude of each.
        window: s, over which outputs are averaged before they are compared.
    """

    tolerance: Annotated[float, in_range(BY_NAME["tolerance"])] | None = None
    error: Annotated[float, quantity("1", maximum=1.0, above=0.0)] | None = None
    window: Duration = 1.0


class FreewheelLimits(Strict):
    """Limits of a freewheel as its maker gives them, those that are given.

    Attributes:
        indexing_frequency: engagements a second above which its sprags do not engage, Hz.
        torque: N.m. slip: overrunning speed, rad/s.
        stiffness: of the closed freewheel, N.m/rad, to estimate the torque of impacts.
    """

    indexing_frequency: Annotated[float, quantity("Hz", above=0.0)] | None = None
    torque: Annotated[float, quantity("N.m", above=0.0)] | None = None
    slip: Annotated[float, quantity("rad/s", above=0.0)] | None = None
    stiffness: Annotated[float, quantity("N.m/rad", above=0.0)] | None = None


class Freewheels(FreewheelLimits):
    """Limits of both freewheels, and of one of them in their place."""

    housing: FreewheelLimits = FreewheelLimits()
    output: FreewheelLimits = FreewheelLimits()

    def of(self, key: str) -> dict[str, float]:
        """Limits of one kind, by freewheel."""
        tables = {"housing": self.housing, "output": self.output}
        found = {name: getattr(table, key) or getattr(self, key) for name, table in tables.items()}
        return {name: limit for name, limit in found.items() if limit is not None}

    def limits(self) -> dict[str, float]:
        """Limits that are given, by the number of the summary that they are of."""
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
    """Length of the run, its steps, and the outputs it records."""

    stop_time: Duration
    communication_step: Annotated[float, quantity("s", maximum=variables.LARGEST_STEP, above=0.0)]
    outputs: list[str] = Field(default=[one.name for one in with_causality(variables.OUTPUT)], min_length=1)

    def check_outputs(self, known: Sequence[str]) -> None:
        """Raise SceneError for an output that is not among these names."""
        for name in self.outputs:
            if name not in known:
                raise SceneError(f"run.outputs: {unknown('output', name, known)}")

    @model_validator(mode="after")
    def _whole_steps(self) -> Run:
        check_number_of_steps(self.stop_time, self.communication_step, "run.communication_step")
        if not whole_steps(self.stop_time, self.communication_step):
            allowed = f"a whole multiple of run.communication_step = {self.communication_step:g} s"
            raise SceneError(must_be("run.stop_time", allowed, f"{self.stop_time:g} s"))
        return self


class Scene(Strict):
    """A scene, checked; all quantities in SI units.

    Attributes:
        title, description: for people. mechanism: parameters that differ from the defaults.
        drive, load, controller: what is around the module. freewheels: their limits.
        accuracy, run: how it is simulated.
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

    @property
    def measured(self) -> str:
        """Name of the controlled speed."""
        return "vehicle_speed" if self.load.kind == "vehicle" else "omega_out"

    @property
    def chooses_fidelity(self) -> bool:
        """Tell whether the fidelity is still to be chosen from measurements."""
        return bool(vars(self.mechanism)["fidelity"] == AUTO)

    @property
    def cycle(self) -> Cycle | None:
        """The driving cycle that a vehicle must follow, published or from a table of the scene, if any."""
        if self.controller is None or self.load.kind != "vehicle":
            return None
        return self.controller.reference.driving_cycle()

    @property
    def signal_units(self) -> dict[str, str]:
        """Units of signals that depend on the scene."""
        return {"reference": "m/s" if self.load.kind == "vehicle" else "rad/s"}

    def drive_torque_limit(self, omega1: float) -> float | None:
        """Return the largest torque of the drive at a speed, N.m; None for a drive without a torque limit.

        Args:
            omega1: speed of link 1, rad/s.
        """
        if isinstance(self.drive, EngineDrive):
            return float(self.drive.torque_map().limits(abs(omega1))[1])
        return self.controller.maximum if isinstance(self.controller, PiTorqueController) else None

    @cached_property
    def built_load(self) -> loops.Load:
        """The load as a system."""
        # freewheels may keep the output shaft from turning backwards
        one_way = all(self.given.get(name, 1.0) for name in ("housing_freewheel", "output_freewheel"))
        start_speed = self.given.get("omega_out_start", 0.0)
        return self.load.build(self.run.communication_step, one_way, start_speed)

    @cached_property
    def tables(self) -> dict[str, Any]:
        """Keys that are given, by table, in SI units."""
        return self.model_dump(exclude_none=True)

    @cached_property
    def surroundings(self) -> Any:
        """The systems, connected: what is around the FMU."""
        return loops.connect(list(self.systems()))

    def systems(self) -> Iterator[Any]:
        """Load, and drive or controller, as systems to connect."""
        step = self.run.communication_step
        load = self.built_load.system
        yield load
        if self.controller is not None:
            yield from self.controller.build(step, self.measured)
        yield from self.drive.systems(step)
        braked = self.controller is not None and self.controller.brake is not None
        if "brake_force" in load.input_labels and not braked:
            yield loops.source("brake_force", 0.0, step)

    @property
    def prescribed(self) -> dict[str, Signal]:
        """Inputs of the module that do not depend on its state, by name."""
        given = [system.signals for system in self.systems() if isinstance(system, Sources)]
        return {name: one[name] for one in given for name in PLANT_INPUTS if name in one}

    def replaced(self, **tables: Mapping[str, Any]) -> Scene:
        """The scene with other keys, checked again; raises as load_scene.

        Args:
            tables: keys by table, such as run={"stop_time": 2.0}; None takes a key away.
        """
        return self.with_keys(
            {f"{table}.{key}": value for table, keys in tables.items() for key, value in keys.items()}
        )

    def with_keys(self, keys: Mapping[str, Any]) -> Scene:
        """The scene with other values by dotted key, checked again; raises as load_scene.

        Args:
            keys: such as {"load.coupling.stiffness": "2 kN.m/rad"}; None takes a key away.
        """
        anew = {name.partition(".")[0] for name in keys}
        # units of a controller depend on the load
        anew |= {"controller"} if "load" in anew else set()
        # a specification gives more than a scene
        given = self.model_fields_set & Scene.model_fields.keys()
        data = {name: self.tables.get(name) if name in anew else getattr(self, name) for name in given}
        for name, value in keys.items():
            data = changed(data, name.split("."), value)
        return validated(Scene, data)

    @cached_property
    def given(self) -> dict[str, float]:
        """Parameters of the mechanism that the scene gives, without a fidelity still to be chosen."""
        values = {name: value for name, value in vars(self.mechanism).items() if name != "satellite"}
        return {name: value for name, value in values.items() if value not in (None, AUTO)}

    @cached_property
    def following(self) -> dict[str, float]:
        """Parameters of the mechanism that follow from sizes and materials of its satellites."""
        satellite: Satellite | None = vars(self.mechanism)["satellite"]
        return {} if satellite is None else satellite.parameters(self.given)

    def with_fidelity(self, fidelity: str, error: float | None = None) -> Scene:
        """The scene at a named fidelity, or at one to be chosen for this error.

        A scene that describes an elastic output has its driven mass rigid with the hub elsewhere.
        """
        asked = {} if error is None else {"error": error}
        if fidelity == AUTO:
            chosen_too = {"method": None, "max_step": None}
            return self.replaced(
                mechanism={"fidelity": AUTO, **chosen_too}, accuracy={**asked, "tolerance": None}
            )
        scene = self.replaced(mechanism={"fidelity": fidelity}, accuracy=asked)
        return scene.replaced(mechanism=at_fidelity(scene.given, scene.given["fidelity"]))

    @property
    def _carrying(self) -> tuple[str, float]:
        """Name and value, kg.m2, of the inertia that a rigid load adds to: of the driven mass if elastic."""
        name = "driven_inertia" if self.given.get("fidelity") == ELASTIC else "output_inertia"
        return name, self.given.get(name, BY_NAME[name].start or 0.0)

    def parameters(self) -> dict[str, float]:
        """Parameters for the FMU with those of the drive; the inertia of a rigid load is added in."""
        values = self.drive.driven({**self.given, **self.following})
        rigid = self.built_load.rigid_inertia
        name, own = self._carrying
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
            load.check_step(self._carrying[1])
            self.drive.check_step(self.run.communication_step, parameters.get("input_inertia", 0.0))
        except ValueError as error:
            raise SceneError(f"run.communication_step: {error}") from None
        try:
            Module("plain").check(**parameters)
        except Refused as error:
            raise SceneError(f"mechanism: {error}") from None
        return self

    def _check_drive(self) -> None:
        """Reject a drive that contradicts [controller] or mechanism.drive."""
        kind, needed, given = self.drive.kind, self.drive.mode, self.given.get("drive")
        if self.controller is None and kind in (PiController.DRIVE, PiTorqueController.DRIVE):
            raise SceneError(f"drive.kind = {kind!r} requires a table [controller]")
        if self.controller is not None and kind != self.controller.DRIVE:
            allowed = f"{self.controller.DRIVE!r} with controller.kind = {self.controller.kind!r}"
            raise SceneError(must_be("drive.kind", allowed, repr(kind)))
        if given is not None and given != needed:
            names = {number: name for name, number, _ in variables.ENUMERATIONS["Drive"]}
            other = "speed" if needed == DRIVE_TORQUE else "torque"
            allowed = f"{names[needed]!r} with drive.kind = {kind!r}"
            demand = must_be("mechanism.drive", allowed, repr(names[int(given)]))
            raise SceneError(f"{demand}. Omit it, or use a drive.kind that prescribes a {other}.")

    def _check_choice(self) -> None:
        """Reject fidelity 'auto' without an allowed error, or with parameters that it chooses."""
        if not self.chooses_fidelity:
            return
        if self.accuracy.error is None:
            raise SceneError("mechanism.fidelity = 'auto' requires accuracy.error, e.g. '1 %'")
        chosen = {f"mechanism.{name}": self.given.get(name) for name in ("method", "max_step")}
        for name, value in {**chosen, "accuracy.tolerance": self.accuracy.tolerance}.items():
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
        for key, given in (("reference.kind = 'cycle'", cycle), ("brake", self.controller.brake is not None)):
            if given:
                allowed = f"'vehicle' with controller.{key}"
                raise SceneError(must_be("load.kind", allowed, repr(self.load.kind)))
