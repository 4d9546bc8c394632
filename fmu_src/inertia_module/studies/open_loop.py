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
from .trajectory import Peer, Trajectory


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
        steps: communication steps, s; by default the whole run, a hundredth and a thousandth of it.
        progress: told how much is done (0 to 1).
    """
    case = reference.case

    def compared(run: Callable[..., Trajectory], *arguments: Any) -> Callable[[Progress], dict[str, Any]]:
        def measured(_: Progress) -> dict[str, Any]:
            found = run(*arguments)
            return {
                "errors": errors(found, reference),
                "wall_time": found.wall_time / case.stop_time,
                "evaluations": found.evaluations,
                "switches": found.number_of_switches,
            }

        return measured

    def run_level(level: Level, step: float) -> Trajectory:
        return KernelRun(case, level.values, step).trajectory(hints=reference.trajectory.switches)[0]

    chosen = list(all_levels(is_elastic(case.parameters))) if levels is None else levels
    lengths = [case.stop_time / number for number in (1, 100, 1000)] if steps is None else steps
    attempts: list[Attempt] = [
        (head_of(level, step), compared(run_level, level, step)) for step in lengths for level in chosen
    ]
    attempts += [
        (Row(PEER, peer.name, label, case.stop_time), compared(peer.integrate, case, setting))
        for peer in peers
        for label, setting in peer.settings.items()
    ]
    return attempt_all(attempts, progress)
