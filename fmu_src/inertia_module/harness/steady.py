"""Steady pulses of a mechanism at a speed ratio: the rigid module, its output shaft held by a large inertia.

Whatever is lost is in it: mean torques, and what is lost of the energy put in, over whole periods of the
drive. Fidelity `averaged` has these means in a map, found once and interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from scipy.optimize import brentq

from ..common.errors import Refused
from ..kernel.inertia import reduced_inertia
from ..memory import Module

# the shaft's inertia over that of the imbalances: in a period its speed changes by some 1e-7 of omega1
HELD = 1e8
# turns of the drive to average over: whole periods of the motion, or where that is long most of it
FEWEST_TURNS, MOST_TURNS = 10, 100
# turns of link 1 after which link 2 has come along where the shaft runs ahead
SETTLING_TURNS = 200
# of the time of a period, which only decides what little of a pulse is missed at its end
TIME_ERROR = 1e-8
# what the start leaves behind is gone where link 2, as many turns later, is as fast within this share of
# omega1; so often this is tried from rest, and then from the speed of the shaft
STEADY = 1e-5
TRIES = 5
# drive angles at which lock-up is looked at
ANGLES = 3000
# of the load on the mount in the time that the drive takes for a turn where link 2 is held
SAMPLES = 60
_FORCE, _MOMENT = ([f"shaking_{kind}_{axis}" for axis in "xyz"] for kind in ("force", "moment"))


class SteadyPulses(NamedTuple):
    """Means over whole periods of the drive.

    Attributes:
        output_torque: what the load takes, N m. input_torque: M1, N m.
        efficiency: power to the load over power in; 0 where nothing comes out.
        link2_ratio: mean speed of link 2 over that of link 1, magnitudes.
        ripple: RMS of the torque in the output freewheel about its mean, N m. peak: its largest, N m.
        bearing_force: the largest on the bearing of a satellite, N.
    """

    output_torque: float
    input_torque: float
    efficiency: float
    link2_ratio: float
    ripple: float
    peak: float
    bearing_force: float


class MountLoad(NamedTuple):
    """The largest load on the mount.

    Attributes:
        force: N. moment: about the origin, N m.
    """

    force: float
    moment: float


class SteadyMachine:
    """A mechanism whose output shaft is held at a speed.

    Args:
        parameters: of the module by name, those that differ from the defaults; as in Module.set.
        kernel: as in Module.

    Attributes:
        ideal: whether it loses nothing and has no weight, so that all goes with the speed squared.

    Raises:
        Refused: the parameters cannot be, or a freewheel is missing.
    """

    def __init__(self, parameters: Mapping[str, float | str], kernel: str = "auto") -> None:
        given = {"fidelity": "rigid", "drive": "speed", "method": "event", "input_hold": "constant"}
        zeros = dict.fromkeys(("max_step", "omega2_start", "omega_out_start", "drive_angle_start"), 0.0)
        self._values: dict[str, float | str] = {**parameters, **given, **zeros}
        self._kernel = kernel
        module = self._started(1.0, 0.0)
        housing, output = (module[f"{name}_freewheel"] for name in ("housing", "output"))
        if housing * output == 0.0:
            raise Refused(
                f"housing_freewheel and output_freewheel must both be 1, are {housing:g} and {output:g}:"
                " without both there is no mean torque"
            )
        d = module.derived
        self.ideal = d.viscous == 0.0 and d.losses == 0.0
        self._derived = d
        period = int(d.period_turns)
        self._turns = min(period * math.ceil(FEWEST_TURNS / period), MOST_TURNS)
        self._tries = TRIES if self._turns % period == 0 else 1
        self._values["output_inertia"] = HELD * (2.0 * module["energy_stored"] + module["link2_inertia"])

    def _started(self, omega1: float, omega_out: float, omega2: float = 0.0) -> Module:
        inputs = {
            "omega1": omega1,
            "load_torque": 0.0,
            "omega2_start": omega2,
            "omega_out_start": omega_out,
        }
        return Module(self._kernel).start(**{**self._values, **inputs})

    def at(self, omega1: float, ratio: float) -> SteadyPulses:
        """Compute the steady pulses.

        Args:
            omega1: speed of link 1, rad/s, not 0. ratio: output over input speed, from 0 to below 1.
        """
        speed = ratio * abs(omega1)
        for start in (0.0, speed):
            module = self._started(omega1, speed, start)
            # what the start leaves behind is mostly gone after this
            module.advance(self._times(omega1, ratio)[1])
            for _ in range(self._tries):
                omega2 = module["omega2"]
                pulses = self._over_turns(module, omega1, ratio)
                if self._tries == 1 or abs(module["omega2"] - omega2) <= STEADY * abs(omega1):
                    return pulses
        return pulses

    def _times(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Bounds of the time that the turns take, s."""
        slowest = self._turns * math.tau / (self._derived.k * abs(omega1))
        # link 2 turns between 0 and the speed of the shaft
        moved = 1.0 - ratio if omega1 > 0.0 else 1.0 + ratio
        return 0.999 * slowest / max(moved, 1.0), 1.001 * slowest / min(moved, 1.0)

    def _over_turns(self, module: Module, omega1: float, ratio: float) -> SteadyPulses:
        """Means over the turns that come now."""
        between = self._times(omega1, ratio)
        slowest = self._turns * math.tau / (self._derived.k * abs(omega1))
        begun, angle = module.save(), _drive_angle(module)
        before = module.read(("energy_in", "energy_lost"))

        def missing(time: float) -> float:
            module.restore(begun)
            module.advance(time)
            return abs(_drive_angle(module) - angle) - self._turns * math.tau

        time = brentq(missing, *between, rtol=TIME_ERROR)
        missing(time)
        taken, lost = (
            now - then for now, then in zip(module.read(("energy_in", "energy_lost")), before, strict=True)
        )
        speed = module["omega_out"]
        return SteadyPulses(
            module["output_torque_mean"] - module["output_friction"] * speed,
            math.copysign(1.0, omega1) * module["input_torque_mean"],
            min(max(1.0 - lost / taken, 0.0), 1.0) if taken > 0.0 else 0.0,
            abs(1.0 - slowest / time),
            module["torque_ripple"],
            module["torque_peak"],
            module["satellite_force_peak"],
        )

    def coasting(self, omega1: float, ratio: float) -> tuple[float, float]:
        """Compute mean torques on the load and of link 1, N m, where the shaft runs ahead: of what rubs.

        Args:
            omega1: speed of link 1, rad/s, not 0. ratio: output over input speed, above 1.
        """
        module = self._started(omega1, ratio * abs(omega1))
        module.advance(SETTLING_TURNS * math.tau / abs(omega1))
        module.advance(MOST_TURNS * math.tau / abs(omega1))
        braked = module["output_torque_mean"] - module["output_friction"] * module["omega_out"]
        return braked, math.copysign(1.0, omega1) * module["input_torque_mean"]

    def mount(self, omega1: float, ratio: float) -> MountLoad:
        """Find the largest load on the mount, of SAMPLES a turn of the drive.

        Args: as in at.
        """
        module = self._started(omega1, ratio * abs(omega1))
        turn = math.tau / (self._derived.k * abs(omega1))
        forces, moments = [], []
        # over the first turns what the start at rest leaves behind goes
        for n in range(2 * self._turns * SAMPLES):
            module.advance(turn / SAMPLES)
            if n >= self._turns * SAMPLES:
                forces.append(math.hypot(*module.read(_FORCE)))
                moments.append(math.hypot(*module.read(_MOMENT)))
        return MountLoad(max(forces), max(moments))

    def lock_up_torque(self, omega1: float) -> float:
        """Find the largest torque on the load at which the drive can stand still in link 1, N m; stick apart.

        That of the imbalances, - k I' omega1^2 / 2, less the viscous friction of link 2 and output shaft.
        """
        d, angles = self._derived, (n / ANGLES * self._turns * math.tau for n in range(ANGLES))
        slope: float = min(reduced_inertia(d, q)[1] for q in angles)  # type: ignore[no-untyped-call]
        held: float = -0.5 * d.k * slope * omega1**2 - (d.b2 + d.b3) * abs(omega1)
        return max(held, 0.0)


def _drive_angle(module: Module) -> float:
    return module["drive_angle"] + math.tau * module["drive_turns"]
