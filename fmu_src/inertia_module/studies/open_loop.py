"""The study of an open-loop case: every level and every peer, each at its settings, against the reference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..harness.simulate import Progress
from ..scene.mechanism import is_elastic
from .errors import errors
from .kernel_runs import KernelRun
from .levels import Level, all_levels
from .reference import Reference
from .rows import PEER, Attempt, Row, attempt_all, head_of
from .trajectory import Case, Peer, Trajectory


def communication_steps(case: Case) -> tuple[float, ...]:
    """The whole run, a hundredth and a thousandth of it, s."""
    return case.stop_time, case.stop_time / 100.0, case.stop_time / 1000.0


def measure(
    reference: Reference,
    levels: Sequence[Level] | None = None,
    peers: Sequence[Peer] = (),
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Rows of all levels in all communication steps, and of all peers, which run the case in one go.

    Args:
        reference: of the case. levels: by default all. peers: beside them.
        steps: communication steps, s. progress: told how much is done (0 to 1).
    """
    case = reference.case

    def compared(run: Callable[[], Trajectory]) -> Callable[[Progress], tuple[Any, ...]]:
        def measured(_: Progress) -> tuple[Any, ...]:
            found = run()
            cost = found.wall_time / case.stop_time
            return errors(found, reference), cost, found.evaluations, found.number_of_switches

        return measured

    def of_module(level: Level, step: float) -> Callable[[], Trajectory]:
        hints = reference.trajectory.switches
        return lambda: KernelRun(case, level.values, step).trajectory(hints=hints)[0]

    def of_peer(peer: Peer, setting: Any) -> Callable[[], Trajectory]:
        return lambda: peer.integrate(case, setting)

    chosen = list(all_levels(is_elastic(case.parameters))) if levels is None else levels
    attempts: list[Attempt] = [
        (head_of(level, step), compared(of_module(level, step)))
        for step in (communication_steps(case) if steps is None else steps)
        for level in chosen
    ]
    attempts += [
        ((PEER, peer.name, label, case.stop_time), compared(of_peer(peer, setting)))
        for peer in peers
        for label, setting in peer.settings.items()
    ]
    return attempt_all(attempts, progress)
