"""The master: one engine, one module, one scheme; a communication step at a time.

Conventions: n numbers the communication points, omega_E and omega_M are the speeds of engine and module, T
the torque the module gave back. Whatever is left between omega_E and omega_M at a communication point is made
up for by a jump at the beginning of the module's next step, whose impulse is in the next step mean.
"""

from __future__ import annotations

from ..instance import DriveError, Fmu
from ..kernel.codes import DRIVE_SPEED
from .bond import Exchange
from .engine import Engine, EngineState, LoadTorque
from .plant import EnginePlant
from .schemes import HELD, IMPLICIT, INERTIA, INSTANTANEOUS, JACOBI, MODULE_FIRST, RAMP, Scheme

_TORQUES = ("input_torque_mean", "input_torque", "energy_in")
# an implicit step has converged when the speeds at its end agree to this, relative
_AGREEMENT = 1e-11
# least of the inertia that a directional derivative may stand for, in engine inertias
_LEAST_SLOPE = -0.5

# what a step leaves for the next one
_MEMORY = (
    "_slope",
    "_torque",
    "_torque_rate",
    "_mean_torque",
    "_energy_now",
    "_module_end",
    "_module_acceleration",
    "_acceleration",
)


class CoupledEngine(EnginePlant):
    """An engine in front of a module; seen from outside it is a plant whose omega1 is the speed asked for.

    Args:
        fmu: a started native FMU of the module with omega1 = speed of the engine, whose drive is speed and
            whose input_hold is constant.
        engine: at the same speed. scheme: of coupling.
        inertia: interface inertia the engine reckons with (correction inertia), kg.m2; see interface.py.
        substeps: equal communication steps between engine and module in each step of the plant.

    Attributes:
        ledger: sums over the run. exchange: of the last communication step, or None.

    Raises:
        ValueError: the speeds differ, no inertia for a correction that needs one, a module driven by torque,
            or no substeps.
    """

    def __init__(
        self, fmu: Fmu, engine: Engine, scheme: Scheme, inertia: float | None = None, substeps: int = 1
    ) -> None:
        if scheme.correction == INERTIA and (inertia is None or not inertia > 0.0):
            raise ValueError(
                f"inertia = {inertia} is refused: allowed is a positive interface inertia, kg.m2"
            )
        super().__init__(fmu, engine, substeps)
        speed, hold, drive = fmu.read(("omega1", "input_hold", "drive"))
        if drive != DRIVE_SPEED:
            raise ValueError(
                "drive = torque of the FMU is refused: allowed is speed here, TorqueDrivenEngine takes torque"
            )
        if abs(speed - engine.speed) > 1e-9 * max(1.0, abs(speed)):
            raise ValueError(
                f"omega1 = {speed:g} rad/s of the FMU is refused: allowed is the engine's {engine.speed:g}"
            )
        if hold != 0.0:
            raise ValueError(
                "input_hold = linear is refused: allowed is constant, the scheme gives the derivative"
            )
        self.scheme = scheme
        self._inertia = inertia if inertia is not None else 0.0
        self._slope = 0.0  # interface inertia an implicit step found last
        self._torque, self._energy = fmu.read(("input_torque", "energy_in"))
        self._torque_rate = 0.0
        self._mean_torque, self._energy_now = self._torque, self._energy
        self._module_speed = self._module_end = engine.speed  # at the ends of its last two steps
        self._module_acceleration = 0.0  # of its last step, jump included
        self._acceleration = 0.0  # of the engine in its last step, mean

    @property
    def energy_stored(self) -> float:
        """Kinetic energy of engine and module together, J."""
        return self.engine.energy_stored + self.fmu["energy_stored"]

    # --- one communication step ---

    def step(self, h: float) -> Exchange:
        """Advance both by one communication step, s.

        Raises:
            DriveError: the FMU refused the step; both are where they were, and a good step goes on.
        """
        memory = {name: getattr(self, name) for name in _MEMORY}
        before = self.engine.state
        try:
            mean_speed = self._exchange(before, h)
        except DriveError:
            self.engine.state = before
            for name, value in memory.items():
                setattr(self, name, value)
            raise
        return self._book(before, mean_speed, h)

    def _exchange(self, before: EngineState, h: float) -> float:
        """Step both in the order of the scheme. Returns the mean of the module's speed."""
        torque_before, acceleration = self._torque, self._acceleration
        if self.scheme.correction == IMPLICIT:
            mean_speed = self._implicit(before, h)
        elif self.scheme.order == MODULE_FIRST:
            mean_speed = self._move_module(h, before.speed, acceleration)
            self._move_engine(h, self._load_behind(torque_before, h))
        elif self.scheme.order == JACOBI:
            self._move_engine(h, self._load_ahead())
            mean_speed = self._move_module(h, before.speed, acceleration)
        else:
            self._move_engine(h, self._load_ahead())
            mean_speed = self._module_follows(before, h)
        return mean_speed

    def _move_engine(self, h: float, load: LoadTorque) -> None:
        start = self.engine.speed
        self.engine.advance(h, load)
        self._acceleration = (self.engine.speed - start) / h

    def _load_ahead(self) -> LoadTorque:
        """Load of an engine that steps before, or beside, the module: the module's last torque goes on."""
        if self.scheme.correction == INERTIA:
            return self._with_inertia(self._inertia)
        return LoadTorque(self._torque, self._torque_rate)

    def _load_behind(self, torque_before: float, h: float) -> LoadTorque:
        """Load of an engine that steps after the module: what the module's torque was in this step."""
        if self.scheme.correction == INERTIA:
            return self._with_inertia(self._inertia)
        if self.scheme.torque == INSTANTANEOUS and self.scheme.speed == RAMP:
            return LoadTorque(torque_before, (self._torque - torque_before) / h)
        return LoadTorque(self._torque)

    def _with_inertia(self, inertia: float) -> LoadTorque:
        """The module's last torque, less what its own acceleration took, plus what the engine's will take."""
        return LoadTorque(self._torque - inertia * self._module_acceleration, 0.0, inertia)

    def _module_follows(self, before: EngineState, h: float) -> float:
        """Step the module after the engine. Returns the mean of its speed."""
        after = self.engine.state
        if self.scheme.speed == RAMP:
            return self._move_module(h, before.speed, (after.speed - before.speed) / h)
        mean = (after.angle - before.angle) / h
        return self._move_module(h, after.speed if self.scheme.speed == HELD else mean, 0.0)

    def _move_module(self, h: float, speed: float, rate: float) -> float:
        """Step the module from a speed on, with a rate if the scheme gives one. Returns its mean speed."""
        self.fmu.set(omega1=speed)
        if self.scheme.speed == RAMP:
            self.fmu.set_rates(omega1=rate)
        else:
            rate = 0.0
        self.fmu.advance(h)
        self.ledger.fmu_steps += 1
        self._mean_torque, instant, self._energy_now = self.fmu.read(_TORQUES)
        self._torque = instant if self.scheme.torque == INSTANTANEOUS else self._mean_torque
        extrapolates = self.scheme.order != MODULE_FIRST and self.scheme.speed == RAMP
        if self.scheme.torque == INSTANTANEOUS and extrapolates:
            (self._torque_rate,) = self.fmu.rates(("input_torque",))
        end = speed + rate * h
        self._module_end = end
        self._module_acceleration = (end - self._module_speed) / h
        return speed + 0.5 * rate * h

    def _implicit(self, before: EngineState, h: float) -> float:
        """Try the step, take it back and make it again. Returns the mean of the module's speed."""
        kept = self.fmu.keep()
        try:
            wanted = self.engine.after(h, self._with_inertia(self._slope)).speed
            mean = self._try_module(before, wanted, h)
            (slope,) = self.fmu.jacobian(("input_torque_mean",), ("omega1",))[0]
            self.ledger.derivatives += 1
            self._slope = max(slope * h, _LEAST_SLOPE * self.engine.inertia)
            for _ in range(self.scheme.iterations):
                tried, torque = wanted, self._torque
                acceleration = (tried - before.speed) / h
                load = LoadTorque(torque - self._slope * acceleration, 0.0, self._slope)
                wanted = self.engine.after(h, load).speed
                if abs(wanted - tried) <= _AGREEMENT * abs(wanted):
                    break
                self.fmu.go_back(kept)
                mean = self._try_module(before, wanted, h)
                secant = (self._torque - torque) / (wanted - tried) * h
                self._slope = max(secant, _LEAST_SLOPE * self.engine.inertia)
        finally:
            self.fmu.forget(kept)
        self._move_engine(h, LoadTorque(self._torque))
        return mean

    def _try_module(self, before: EngineState, wanted: float, h: float) -> float:
        if self.scheme.speed == RAMP:
            return self._move_module(h, before.speed, (wanted - before.speed) / h)
        return self._move_module(h, wanted, 0.0)

    def _book(self, before: EngineState, mean_speed: float, h: float) -> Exchange:
        after = self.engine.state
        self.exchange = Exchange(
            h,
            (after.angle - before.angle) / h,
            mean_speed,
            (after.impulse_out - before.impulse_out) / h,
            self._mean_torque,
            after.work_out - before.work_out,
            self._energy_now - self._energy,
        )
        self._energy, self._module_speed = self._energy_now, self._module_end
        self.ledger.add(self.exchange)
        return self.exchange
