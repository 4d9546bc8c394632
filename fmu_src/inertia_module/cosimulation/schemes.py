"""Schemes that couple an engine and a module: who goes first, what is exchanged, what corrects it."""

from __future__ import annotations

from dataclasses import dataclass

JACOBI, ENGINE_FIRST, MODULE_FIRST = "jacobi", "engine first", "module first"
ORDERS = (JACOBI, ENGINE_FIRST, MODULE_FIRST)
MEAN, INSTANTANEOUS = "mean", "instantaneous"
HELD, RAMP, AVERAGE = "held", "ramp", "average"
NONE, INERTIA, IMPLICIT = "none", "inertia", "implicit"

_ALLOWED = {
    "order": ORDERS,
    "torque": (MEAN, INSTANTANEOUS),
    "speed": (HELD, RAMP, AVERAGE),
    "correction": (NONE, INERTIA, IMPLICIT),
}


@dataclass(frozen=True)
class Scheme:
    """A scheme of coupling.

    Attributes:
        order: jacobi (both step with what was at the communication point), engine first or module first
            (Gauss-Seidel: the second one has what the first one did in this step).
        torque: what the engine gets, the step mean of the input torque or its value at an instant.
        speed: what the module gets. held: the newest speed known, constant. ramp: with its derivative, from
            the speed now to the newest one known, else extrapolated. average: the mean over the engine's
            step, held.
        correction: none; inertia: the engine reckons with the interface inertia for what its own speed
            changes in the torque; implicit: the step is tried, taken back and made again with the
            torque that its directional derivative says the engine's answer will lead to.
        iterations: corrections of an implicit step; with more than one they go on by secants.

    Raises:
        ValueError: a word that is not allowed, or a combination that makes no sense.
    """

    order: str = ENGINE_FIRST
    torque: str = MEAN
    speed: str = RAMP
    correction: str = NONE
    iterations: int = 1

    def __post_init__(self) -> None:
        for name, allowed in _ALLOWED.items():
            value = getattr(self, name)
            if value not in allowed:
                raise ValueError(f"{name} = {value!r} is refused: allowed is {', '.join(allowed)}")
        if self.iterations < 1:
            raise ValueError(f"iterations = {self.iterations} is refused: allowed is a whole number from 1")
        if self.speed == AVERAGE and self.order != ENGINE_FIRST:
            raise ValueError(
                f"speed = 'average' is refused with order = {self.order!r}: allowed is engine first"
            )
        if self.torque == INSTANTANEOUS and self.correction != NONE:
            raise ValueError(
                f"correction = {self.correction!r} is refused with instantaneous torque: allowed is the mean"
            )
        if self.correction == IMPLICIT and (self.order != ENGINE_FIRST or self.speed == AVERAGE):
            raise ValueError(
                f"an implicit correction is refused with order = {self.order!r}, speed = {self.speed!r}:"
                " allowed is engine first with held or ramp"
            )


def _explicit() -> dict[str, Scheme]:
    found = {}
    for torque in (INSTANTANEOUS, MEAN):
        for order in ORDERS:
            for speed in (HELD, RAMP):
                found[f"{torque} {order} {speed}"] = Scheme(order, torque, speed)
    return found


# the schemes that are measured, by name
SCHEMES = {
    **_explicit(),
    "mean engine first average": Scheme(speed=AVERAGE),
    "inertia jacobi held": Scheme(JACOBI, speed=HELD, correction=INERTIA),
    "inertia engine first held": Scheme(speed=HELD, correction=INERTIA),
    "inertia engine first ramp": Scheme(correction=INERTIA),
    "inertia module first ramp": Scheme(MODULE_FIRST, correction=INERTIA),
    "implicit held": Scheme(speed=HELD, correction=IMPLICIT),
    "implicit ramp": Scheme(correction=IMPLICIT),
}
