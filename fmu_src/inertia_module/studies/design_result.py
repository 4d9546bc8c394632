"""Result of a design: verified designs with their caveats, and the verdict in words."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..common.equality import ByContent
from ..common.errors import InertiaModuleError
from ..interface.variables import BY_NAME
from ..scene import Scene
from ..scene.loads import VehicleLoad
from ..scene.vehicle_metrics import TRACTIVE_FORCE
from .design_judge import Judge
from .design_specification import metric_text, text_of
from .evaluation import Row
from .search import SPREAD, Searched
from .steady_metrics import SteadyMechanism

# minimum angle of a moving load, rad: one revolution of the output shaft, or of the wheels of a vehicle
MIN_MOTION = math.tau
# Numbers in messages, which differ from design to design
NUMBER = re.compile(r"[-+]?\d[\d.e+-]*")


@dataclass(frozen=True, eq=False)
class Finalist(ByContent):
    """Verified design.

    Attributes:
        searched: Row at the fidelity of the search.
        checked: Row at the fidelity of the verification.
        scene: Scene of the design.
        file: File of the scene.
        doubts: Caveats: a sentence by short name.
    """

    searched: Row
    checked: Row
    scene: Scene
    file: Path
    doubts: dict[str, str]


def caveats_of(scene: Scene, metrics: Mapping[str, float], speed: float) -> dict[str, str]:
    """Return caveats of a design that satisfies its limits: a sentence by short name.

    Args:
        scene: Scene of the design.
        metrics: Metrics of its verification.
        speed: Speed of link 1 for lock-up and torque of the drive, rad/s.
    """
    caveats, mechanism = {}, SteadyMechanism(scene.parameters())
    try:
        chart = mechanism.chart(speed)
        if not chart.lock_up_torque[0] > 0.0:
            caveats["no lock-up"] = f"no torque is transmitted above a speed ratio of {chart.end_ratio:.2g}"
        limit = scene.drive_torque_limit(speed)
        if limit is not None and (beyond := chart.beyond_drive(speed, limit)):
            caveats["drive too weak"] = beyond
    except InertiaModuleError as error:
        caveats["no mean torque"] = str(error)
    if mechanism.module["satellite_inertia"] == 0.0:
        caveats["satellites without inertia"] = "satellite_inertia is 0"
    # angle of the wheels of a vehicle, or upper bound of the angle of another load; infinite without a run
    angle = metrics.get("omega_out_maximum", math.inf) * scene.run.stop_time
    if isinstance(scene.load, VehicleLoad):
        angle = metrics.get("distance", math.inf) / scene.load.wheel_radius
    if isinstance(scene.load, VehicleLoad) and metrics.get(TRACTIVE_FORCE, 0.0) > (
        scene.load.grip or math.inf
    ):
        force, grip = metrics[TRACTIVE_FORCE], scene.load.grip
        caveats["wheels slip"] = f"the tractive force reaches {force:.4g} N, the grip is {grip:.4g} N"
    if angle < MIN_MOTION:
        caveats["load does not move"] = f"{angle / math.tau:.2g} revolutions in the run"
    return caveats


@dataclass(frozen=True, eq=False, repr=False)
class DesignResult(ByContent):
    """Result of a design.

    Attributes:
        judge: Judge, with the specification in ``spec``.
        rows: All designs of the search, in the order of evaluation.
        front: Pareto front of the designs that satisfy all limits.
        finalists: Verified designs.
        new: Number of rows that were not in the journal.
        files: Paths of the written files, by kind.
        searched: Outcome of the search, with the best metrics of each start.
    """

    judge: Judge
    rows: list[Row]
    front: list[Row]
    finalists: list[Finalist]
    new: int
    files: dict[str, Path]
    searched: Searched

    def __repr__(self) -> str:
        verified = f"{len(self.chosen)} of {len(self.finalists)} verified designs satisfy all limits"
        return f"DesignResult({len(self.rows)} designs; {verified})"

    @property
    def cut(self) -> bool:
        """Return True if the time limit ended the search."""
        return self.searched.is_cut

    @property
    def chosen(self) -> list[Finalist]:
        """Return the finalists that satisfy all limits at the fidelity of the verification."""
        return [finalist for finalist in self.finalists if self.judge.meets(finalist.checked)]

    def lines(self, finalist: Finalist) -> dict[str, str]:
        """Return values, metrics and caveats of a finalist as texts by name.

        Args:
            finalist: The finalist.
        """
        keys = {
            name: text_of(value, self.judge.unit(name)) for name, value in finalist.searched.point.items()
        }
        keys |= {name: text_of(value, BY_NAME[name].unit) for name, value in finalist.scene.following.items()}
        metrics = {}
        for name in self.judge.spec.metrics:
            checked = metric_text(finalist.checked, name, self.judge.unit(name))
            metrics[name] = f"{metric_text(finalist.searched, name)} → {checked}"
        violated = [limit.metric for limit in self.judge.limits if limit.violation(finalist.checked) > 0.0]
        limits = f"violated: {', '.join(violated)}" if violated else "satisfied"
        caveats = {f"caveat: {name}": reason for name, reason in finalist.doubts.items()}
        return keys | metrics | {"limits": limits} | caveats

    def verdict(self) -> str:
        """Return a sentence with the number of valid designs, the tightest limit, convergence and caveats."""
        finalists, search = self.finalists, self.judge.spec.search
        # Without a valid design the closest one is described: a verified design if there is any.
        rows = [finalist.checked for finalist in self.chosen or finalists]
        rows = rows or [row for row in self.rows if not row.refused]
        row = rows[0] if self.chosen else min(rows, key=self.judge.total_violation)
        limit = self.judge.tightest(row, self.rows)
        if self.chosen:
            first = self.chosen[0].file.stem.replace("_", " ")
            notes = f"; tightest in {first}: {limit}" if limit else ""
            names = [name for finalist in self.chosen for name in finalist.doubts]
            doubts = ", ".join(f"{name} in {names.count(name)}" for name in dict.fromkeys(names))
            notes += f"; caveats: {doubts} of them" if doubts else ""
            number = f"{len(self.chosen)} of {len(finalists)} verified designs satisfy all limits"
            return f"{number}; {self.convergence()}{notes}{self.rejections()}"
        designs = f"{len(self.rows)} designs"
        reason = f"no improvement in the last {search.stall} generations of {search.starts} starts"
        if self.front:
            designs = f"{len(finalists)} verified designs"
            reason = f"{len(self.front)} of {len(self.rows)} designs do with fidelity {search.fidelity!r}"
        elif self.cut:
            reason = f"search.longest = {search.longest:g} s ended the search before it was complete"
        return f"0 of {designs} satisfy all limits; {reason}; closest design: {limit}{self.rejections()}"

    def rejections(self) -> str:
        """Return the number of designs that were rejected with the most frequent reason; "" without any."""
        reasons = [row.refused for row in self.rows if row.refused]
        if not reasons:
            return ""
        kinds = [NUMBER.sub("", reason) for reason in reasons]
        example = reasons[kinds.index(Counter(kinds).most_common(1)[0][0])]
        return f"; {len(reasons)} of {len(self.rows)} designs were rejected, most often: {example}"

    def convergence(self) -> str:
        """Return a sentence that compares the best designs of the starts."""
        searched, search = self.searched, self.judge.spec.search
        starts, successful = searched.starts, [start for start in searched.starts if start.best]
        texts = []
        for goal, spread in searched.spread().items():
            values = ", ".join(f"{start.best[goal]:.4g}" for start in successful)
            texts.append(f"{goal} {values} {self.judge.unit(goal)} (spread {100.0 * spread:.2g} %)")
        best = f"best of {len(successful)} starts: {', '.join(texts)}"
        if searched.has_converged:
            return f"converged; {best}"
        if searched.is_cut:
            reason = f"search.longest = {search.longest:g} s ended the search"
        elif len(starts) < 2:
            reason = "one start shows no spread; increase search.starts"
        elif len(successful) < len(starts):
            reason = (
                f"{len(starts) - len(successful)} of {len(starts)} starts found no design within the limits"
            )
        else:
            reason = f"the best designs of the starts differ by more than {100.0 * SPREAD:g} %"
            reason += "; increase search.generations or search.population"
        return f"not converged: {reason}" + (f"; {best}" if texts else "")
