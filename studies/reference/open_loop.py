"""The study of an open-loop case: every level and every peer, each at its settings, against the reference."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from inertia_module.fidelity.choice import Choice
from inertia_module.fidelity.levels import Level, all_levels
from inertia_module.fidelity.rows import PEER, Attempt, Row, attempt_all, head_of
from inertia_module.fidelity.tradeoff import Study
from inertia_module.harness.simulate import Progress
from inertia_module.scene.mechanism import is_elastic

from .errors import MEASURES, errors
from .kernel_runs import KernelRun
from .reference import Agreement, Reference, agreement, converged
from .trajectory import Case, Peer, Trajectory, Unavailable

R1 = Case()
# an output shaft for R1: hub, spring, damper and driven mass
R1_ELASTIC = Case(
    {"output_inertia": 0.02, "driven_inertia": 0.5, "shaft_stiffness": 400.0, "shaft_damping": 0.05}
)
PLOTTED = "omega_out_worst"


@dataclass(frozen=True)
class OpenStudy(Study):
    """A study of an open-loop case.

    Attributes:
        agreement: of the reference with the second method, or None.
    """

    agreement: Agreement | None = None

    def as_dict(self) -> dict[str, Any]:
        """The same for machines."""
        agreed = {} if self.agreement is None else {"reference_agreement": dataclasses.asdict(self.agreement)}
        return super().as_dict() | agreed

    def closing_lines(self, choice: Choice | None) -> list[str]:
        """What failed, how far the reference can be trusted, and what is recommended."""
        lines = super().closing_lines(choice)
        if self.agreement is not None:
            lines.insert(
                0,
                f"reference: two independent methods agree to {self.agreement.omega_out:.1e} in omega_out"
                f" (relative) and to {self.agreement.events:.1e} s in the times of"
                f" {self.agreement.switches[0]} switches",
            )
        return lines


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


def open_study(
    case: Case, title: str, peers: Sequence[Peer] = (), progress: Progress | None = None
) -> OpenStudy:
    """Measure an open-loop case: fidelity, method, tolerance or step, and communication step; and peers.

    Args:
        case: what is run. title: of it. peers: beside it. progress: told how much is done (0 to 1).

    Raises:
        Refused: the module refuses the case.
    """
    reference = converged(case)
    try:
        agreed = agreement(case)
    except Unavailable:
        agreed = None
    rows = measure(reference, peers=peers, progress=progress)
    return OpenStudy(title, rows, tuple(MEASURES), PLOTTED, agreed)
