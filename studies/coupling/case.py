"""The cases that are measured: a module, the engine in front of it, a load, and how long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from inertia_module.cosimulation import Engine, EngineMap, Governor, InterfaceInertia, interface_inertia

# a launch lasts as long, and speeds are averaged and compared over windows, s
STOP_TIME, WINDOW = 1.0, 0.02
WINDOWS = round(STOP_TIME / WINDOW)
# the governor closes its loop at this rate, rad/s, on engine and module together; its integral at a quarter
_BANDWIDTH = 20.0
# limits of the torque, N.m
_GREATEST, _DRAG = 200.0, 20.0

URBAN_MODULE = {
    "layout": 1.0,
    "sun_radius": 0.1,
    "satellite_radius": 0.06,
    "eccentricity": 0.04,
    "imbalance_mass": 0.3,
    "satellites": 3.0,
    "link2_inertia": 0.01,
}


def governor(inertia: float) -> Governor:
    """A governor for what turns with the engine, its rotor included, kg.m2."""
    gain = _BANDWIDTH * inertia
    return Governor(gain, 0.25 * _BANDWIDTH * gain, sample_time=0.005)


@dataclass(frozen=True)
class CoupledCase:
    """An engine that holds its speed while the module launches the output shaft.

    Attributes:
        name: as the table calls it. parameters: of the module, those that differ from the defaults.
        speed: the governor's, also that at the start, rad/s. load_torque: N.m.
        ratio: greatest interface inertia over the inertia of the engine.
    """

    name: str
    parameters: Mapping[str, float]
    speed: float
    load_torque: float
    ratio: float

    @cached_property
    def interface(self) -> InterfaceInertia:
        """Interface inertia of the module, kg.m2."""
        return interface_inertia(self.parameters)

    @property
    def engine_inertia(self) -> float:
        """Inertia of the engine, kg.m2."""
        return self.interface.greatest / self.ratio

    def engine(self) -> Engine:
        """The engine at the start of the case."""
        limits = EngineMap((0.0,), (_GREATEST,), (_DRAG,))
        return Engine(
            self.engine_inertia,
            limits,
            governor(self.engine_inertia + self.interface.mean),
            self.speed,
            self.speed,
        )


def planar(ratio: float) -> CoupledCase:
    """The module of the urban scene, launching 1 kg.m2."""
    return CoupledCase("planar", {**URBAN_MODULE, "output_inertia": 1.0}, 200.0, 8.0, ratio)


def bevel(ratio: float) -> CoupledCase:
    """The module of scene R1."""
    return CoupledCase("bevel", {}, 100.0, 10.0, ratio)


CASES = {"planar": planar, "bevel": bevel}
