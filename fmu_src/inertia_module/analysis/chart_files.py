"""Maps and converter tables of a mechanism, and their files: CSV, MAT and VECTO."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..common.errors import ParameterError
from ..common.terminal import Progress
from ..common.units import factor_between
from ..fmi.results import write_columns, write_mat, write_rows
from .converter_chart import RATIOS, TORQUES, TorqueConverterChart, means_over_ratios
from .steady_state import Array, SteadyMachine

# input speeds of a map, relative to its maximum speed
MAP_SPEEDS = np.geomspace(0.1, 1.0, 8)
# limits of a converter table: maximum torque ratio, and minimum input torque relative to its maximum
MAX_TORQUE_RATIO, MIN_TORQUE_SHARE = 50.0, 1e-4
# speed ratios of the coast side of a converter table, relative to 1 or to the end ratio above 1
COAST_RATIOS = np.array([1.01, 1.1, 1.25, 1.5, 2.0])
# units of the columns of maps and converter tables; other columns are pure numbers
UNITS = {**dict.fromkeys(TORQUES, "N.m"), "loss": "W", "capacity_factor": "rad/s/(N.m)^0.5"}
# columns of a map: fields of SteadyMeans
MAP_COLUMNS = ("input_torque", "output_torque", "loss", "efficiency", "ripple")
VECTO_HEADINGS = ("Speed Ratio", "Torque Ratio", "Input Torque at reference rpm")


def steady_map(machine: SteadyMachine, omega1: float, progress: Progress) -> dict[str, Array]:
    """Compute the map of a mechanism from a tenth of an input speed up to this speed.

    Args:
        machine: the mechanism.
        omega1: maximum input speed, rad/s, not 0.
        progress: function that receives the completed share, 0 to 1.

    Returns:
        Columns by name: omega1, rad/s, shape (m,), speed_ratio, shape (n,), and MAP_COLUMNS, shape (m, n).
    """
    speeds, rows = omega1 * MAP_SPEEDS, []
    for speed in speeds:
        rows.append(means_over_ratios(machine, speed))
        progress(len(rows) / speeds.size)
    columns = {name: np.array([row[name] for row in rows]) for name in MAP_COLUMNS}
    return {"omega1": speeds, "speed_ratio": RATIOS, **columns}


def save_map(
    columns: Mapping[str, Array], stem: Path, unit: str = "rad/s", tables: bool = False
) -> list[Path]:
    """Write a map as stem.csv, with a row for each speed and ratio; files are written atomically.

    Args:
        columns: result of steady_map.
        stem: path of the files without their endings.
        unit: unit of the speeds.
        tables: True to write also stem_COLUMN.csv, with a row for each ratio and a column for each speed,
            and stem.mat with a struct map.

    Returns:
        Paths of the files.
    """
    speeds, ratios = columns["omega1"] * factor_between("rad/s", unit), columns["speed_ratio"]
    units = {"omega1": unit, **UNITS}
    grid = dict(zip(("omega1", "speed_ratio"), np.meshgrid(speeds, ratios, indexing="ij"), strict=True))
    long = {name: values.ravel() for name, values in {**columns, **grid}.items()}
    files = [write_columns(Path(f"{stem}.csv"), long, units)]
    if not tables:
        return files
    for name in MAP_COLUMNS:
        rows = zip(speeds, columns[name], strict=True)
        wide = {f"{name} at {speed:.6g} {unit}": row for speed, row in rows}
        wide_units = dict.fromkeys(wide, units.get(name, ""))
        files.append(write_columns(Path(f"{stem}_{name}.csv"), {"speed_ratio": ratios, **wide}, wide_units))
    return [*files, write_mat(Path(f"{stem}.mat"), "map", {**columns, "omega1": speeds}, units)]


def converter_table(machine: SteadyMachine, chart: TorqueConverterChart, omega1: float) -> dict[str, Array]:
    """Compute the converter table of a mechanism.

    The output torque of the table is exact at each ratio (chart.md).

    Args:
        machine: the mechanism.
        chart: chart of the mechanism at this speed.
        omega1: input speed, rad/s, not 0.

    Returns:
        Finite columns by name, shape (n,) each: speed_ratio, output speed relative to input speed, increasing
        from 0; torque_ratio, output torque relative to input torque, limited to MAX_TORQUE_RATIO,
        negative if the mechanism brakes the shaft; capacity_factor, omega1 / sqrt(input torque),
        rad/s/(N m)^0.5; output_torque and input_torque, means of the mechanism itself, N m.

    Raises:
        ParameterError: the mechanism transmits no torque at any ratio.
    """
    ratios = COAST_RATIOS * max(1.0, chart.end_ratio)
    coast = np.zeros((ratios.size, 2))
    if not machine.ideal:
        coast = np.array([machine.coasting(omega1, ratio) for ratio in ratios])
    square = omega1 * omega1
    output = np.concatenate([square * chart.output_torque, coast[:, 0]])
    input_torque = np.concatenate([square * chart.input_torque, coast[:, 1]])
    maximum = float(input_torque.max())
    if not maximum > 0.0:
        raise ParameterError(
            f"a converter table requires torque; the mechanism transmits none at {omega1:g} rad/s"
        )
    minimum = np.maximum(output / MAX_TORQUE_RATIO, MIN_TORQUE_SHARE * maximum)
    limited = np.maximum(input_torque, minimum)
    return {
        "speed_ratio": np.concatenate([chart.speed_ratio, ratios]),
        "torque_ratio": output / limited,
        "capacity_factor": abs(omega1) / np.sqrt(limited),
        "output_torque": output,
        "input_torque": input_torque,
    }


def save_converter(table: Mapping[str, Array], omega1: float, stem: Path) -> list[Path]:
    """Write a converter table to stem.csv, stem.mat and stem.vtcc, each atomically.

    The MAT file contains a struct converter with units. The .vtcc file is for VECTO. Its input torque at the
    reference speed omega1 has a sign: it is negative if the shaft drives link 1.

    Args:
        table: result of converter_table.
        omega1: input speed, rad/s.
        stem: path of the files without their endings.

    Returns:
        Paths of the files.
    """
    output, input_torque = table["output_torque"], table["input_torque"]
    minimum = np.maximum(np.abs(output) / MAX_TORQUE_RATIO, MIN_TORQUE_SHARE * input_torque.max())
    limited = np.copysign(np.maximum(np.abs(input_torque), minimum), input_torque)
    columns = (table["speed_ratio"], output / limited, limited)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    units = {"omega1": "rad/s", **UNITS}
    return [
        write_columns(Path(f"{stem}.csv"), table, units),
        write_mat(Path(f"{stem}.mat"), "converter", {"omega1": omega1, **table}, units),
        write_rows(Path(f"{stem}.vtcc"), VECTO_HEADINGS, rows),
    ]
