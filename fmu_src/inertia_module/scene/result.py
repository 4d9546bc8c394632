"""Result of a scene: a table over time and a summary."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .. import __version__
from ..common.errors import Named
from ..common.units import printed_unit
from ..fmi.results import html_table
from ..fmi.simulate import Result
from ..interface.variables import LOCAL, OUTPUT
from .headings import heading
from .quantity import Quantity
from .schema import Scene

if TYPE_CHECKING:
    from ..common.colours import Picture
    from .shaft import ShaftScene


@dataclass(frozen=True, eq=False, kw_only=True, repr=False, match_args=False)
class SceneResult(Result):
    """Result of a scene, of a module or of a driven shaft alone: a table over time and a summary.

    The columns are the outputs of the scene, the signals of the loop, and more variables that the summary
    requires.

    Attributes:
        columns: Columns by name, shape (n,) each.
        units: Units of the columns, by name.
        origin: None.
        scene: The scene.
        quantities: Metrics with units, by name.
        summary: Values of the metrics, by name.
        metric_units: Units of the metrics, by name; "" for counts and ratios.
        remarks: Notes on missing or doubtful metrics, by name, such as a speed that is not reached.
        limits: Limits in the scene, by metric, in the unit of the metric.
        warnings: Warnings of the FMU, of exceeded limits, and of tables that do not match the run time.
    """

    scene: Scene | ShaftScene
    quantities: dict[str, Quantity]
    remarks: dict[str, str] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"SceneResult({self.scene.title!r}, {self._size_text()})"

    @property
    def table(self) -> Result:
        """Return the table of the outputs of the scene and the signals of the loop."""
        variables = self.scene.VARIABLES.values()
        outputs = {row.name for row in variables if row.causality in (OUTPUT, LOCAL)}
        return self.record.without(outputs - set(self.scene.run.outputs))

    @property
    def record(self) -> Result:
        """Return all columns as a table without the summary."""
        return Result(self.columns, self.units)

    @property
    def summary(self) -> dict[str, float]:
        """Return the values of the metrics by name."""
        values = {name: quantity.value for name, quantity in self.quantities.items()}
        return Named(values, "metric of the summary", self.remarks)

    @property
    def metric_units(self) -> dict[str, str]:
        """Return the units of the metrics by name; "" for counts and ratios."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}

    def as_dict(self) -> dict[str, object]:
        """Return version, title, parameters, summary, units, limits, notes and warnings, for JSON."""
        parameters = self.scene.parameters()
        parameter_units = {name: self.scene.VARIABLES[name].unit for name in parameters}
        return {
            "inertia_module": __version__,
            "title": self.scene.title,
            "parameters": parameters,
            "summary": self.summary,
            "units": parameter_units | self.metric_units,
            "limits": self.limits,
            "remarks": self.remarks,
            "warnings": list(self.warnings),
        }

    def lines(self) -> dict[str, str]:
        """Return the metrics with units and limits, and the notes, as texts by heading."""
        numbers = {
            name: f"{value:.6g} {printed_unit(unit)}".rstrip()
            for name, (value, unit) in self.quantities.items()
        }
        for name, limit in self.limits.items():
            numbers[name] += f", limit {limit:.6g}"
        return {heading(name): text for name, text in (numbers | self.remarks).items()}

    def plot(self, *names: str) -> Picture:
        """Plot columns over time, with one panel for each unit, as Result.plot.

        Args:
            names: Names of columns; without names the outputs of the scene and the signals of the loop.
        """
        return super().plot(*(names or self.table.names[1:]))

    def _repr_html_(self) -> str:
        """Return the plot and the summary as HTML, for notebooks."""
        picture = base64.b64encode(self._repr_png_()).decode()
        return f'<img src="data:image/png;base64,{picture}">' + html_table(
            (self.scene.title, ""), self.lines().items()
        )
