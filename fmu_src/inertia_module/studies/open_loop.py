"""The study of an open-loop case: every rung and every peer, each at its settings, against the reference."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence

from ..drive import Progress
from ..scene.mechanism import is_elastic
from .errors import MEASURES, errors
from .kernel_runs import KernelRun
from .reference import Reference
from .rungs import Rung, ladder
from .trajectory import Case, Peer, Row, Trajectory

PEER = "peer"
# what a run may end with: refusals, missing libraries, integrators that give up
FAILURES = (ValueError, RuntimeError, ArithmeticError, MemoryError)


def communication_steps(case: Case) -> tuple[float, ...]:
    """The whole run, a hundredth and a thousandth of it, s."""
    return case.stop_time, case.stop_time / 100.0, case.stop_time / 1000.0


def _row(
    rung: str, method: str, setting: str, step: float, reference: Reference, run: Callable[[], Trajectory]
) -> Row:
    """Measure a run; what fails is a row with the reason."""
    try:
        found = run()
        measured = errors(found, reference)
    except FAILURES as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        nothing = dict.fromkeys(MEASURES, math.nan)
        return Row(rung, method, setting, step, nothing, math.nan, math.nan, None, reason)
    count = found.number_of_switches if found.switches is None else found.switches.size
    wall_time = found.wall_time / reference.case.stop_time
    return Row(rung, method, setting, step, measured, wall_time, found.evaluations, count)


def rung_row(rung: Rung, step: float, reference: Reference) -> Row:
    """Row of a rung of the module in communication steps, s."""

    def run() -> Trajectory:
        hints = reference.trajectory.switches
        return KernelRun(reference.case, rung.values, step).trajectory(hints=hints)[0]

    row = _row(rung.fidelity_name, rung.method_name, rung.setting, step, reference, run)
    return dataclasses.replace(row, parameters=rung.values)


def peer_rows(peer: Peer, reference: Reference) -> Iterable[Row]:
    """Rows of a peer at all its settings: it runs the case in one go."""
    case = reference.case
    for label, setting in peer.settings.items():

        def run(setting: object = setting) -> Trajectory:
            return peer.integrate(case, setting)

        yield _row(PEER, peer.name, label, case.stop_time, reference, run)


def measure(
    reference: Reference,
    rungs: Sequence[Rung] | None = None,
    peers: Sequence[Peer] = (),
    steps: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Rows of all rungs in all communication steps, and of all peers.

    Args:
        reference: of the case. rungs: by default the whole ladder. peers: beside it.
        steps: communication steps, s. progress: told how much is done (0 to 1).
    """
    chosen = list(ladder(is_elastic(reference.case.parameters)) if rungs is None else rungs)
    lengths = communication_steps(reference.case) if steps is None else steps
    total = len(chosen) * len(lengths) + sum(len(peer.settings) for peer in peers)
    rows: list[Row] = []

    def keep(row: Row) -> None:
        rows.append(row)
        if progress is not None:
            progress(len(rows) / total)

    for length in lengths:
        for rung in chosen:
            keep(rung_row(rung, length, reference))
    for peer in peers:
        for row in peer_rows(peer, reference):
            keep(row)
    return rows
