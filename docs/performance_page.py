"""Values for docs/verification/performance.md, from the committed tables that `make bench` writes."""

import csv
from pathlib import Path

from inertia_module.fidelity.choice import recommend
from inertia_module.fidelity.rows import PEER, read_rows
from inertia_module.scene import load_scene

HERE = Path(__file__).parent / "verification"
URBAN = HERE.parents[1] / "examples" / "urban.toml"
R1 = "scene R1 at an error of 1e-6"
MAX_ERROR = 1e-6
ERROR = "omega_out_final"
# cases of performance.csv in the order of the page
CASES = (
    *("kernel, compiled, one step of 1 s", "kernel, compiled, steps of 1 ms"),
    *("hand-written C, one step of 1 s", "hand-written C, steps of 1 ms"),
    *("native FMU in an fmpy loop, steps of 1 ms", "Python FMU in an fmpy loop, steps of 1 ms"),
    "kernel, plain Python, one step of 1 s",
)
# first words of the methods of other programs
PEERS = ("SciPy", "CVODE", "MuJoCo")


def read_measurements():
    """Read performance.csv: values by part, quantity and case."""
    parts = {}
    with (HERE / "performance.csv").open() as stream:
        for row in csv.DictReader(stream):
            quantities = parts.setdefault(row["part"], {}).setdefault(row["quantity"], {})
            quantities[row["case"]] = float(row["value"])
    return parts


def fastest(rows, error, max_error):
    """Return the fastest run with at most this error, or None."""
    accurate = [row for row in rows if not row.failure and row.errors[error] <= max_error]
    return min(accurate, key=lambda row: row.wall_time, default=None)


def table(measured, rows):
    """Return a line for each form of the module, for hand-written C and for the fastest run of each peer."""
    kernel = measured["time"][CASES[0]]
    lines = [
        "| run | relative error | ms per simulated second | right-hand-side evaluations | time over kernel |",
        "|---|---|---|---|---|",
    ]
    for case in CASES:
        error, time = measured["error"][case], measured["time"][case]
        count = measured["right-hand sides"][case]
        lines.append(f"| {case} | {error:.0e} | {time:.3g} | {count:.0f} | {time / kernel:.2g} |")
    peers = [row for row in rows if row.fidelity == PEER and not row.failure]
    ours = fastest([row for row in rows if row.fidelity != PEER], ERROR, MAX_ERROR)
    for name in PEERS:
        runs = [row for row in peers if row.method.startswith(name)]
        row = fastest(runs, ERROR, MAX_ERROR) or min(runs, key=lambda row: row.errors[ERROR])
        cost = f"{1e3 * row.wall_time:.3g} | {row.evaluations:.0f} | {row.wall_time / ours.wall_time:.2g}"
        lines.append(f"| {row.method}, {row.setting} | {row.errors[ERROR]:.0e} | {cost} |")
    return "\n".join(lines)


def peer_lines(rows):
    """Compare the fastest peer with the fastest run of the module, for each maximum error over the run."""
    for max_error in (1e-2, 1e-4, MAX_ERROR):
        ours, peer = (
            fastest([row for row in rows if (row.fidelity == PEER) is is_peer], "omega_out_worst", max_error)
            for is_peer in (False, True)
        )
        yield f"- **Error of at most {max_error:.0e} over the whole second.**"
        yield f"  The fastest run of the module is `{ours.label}`."
        if peer is not None:
            name, ratio = f"`{peer.method}, {peer.setting}`", peer.wall_time / ours.wall_time
            yield f"  The fastest other program is {name}, which takes {ratio:.0f} times as long."


def urban_choice():
    """Return the levels that fidelity auto selects for the urban scene at 1 %."""
    rows = read_rows(HERE / "tradeoff_urban.csv")
    outputs = load_scene(URBAN).run.outputs
    plain = recommend(rows, 0.01, outputs).row
    with_acceleration = recommend(rows, 0.01, [*outputs, "imbalance_acceleration"]).row
    names = " and ".join(f"`{name}`" for name in outputs)
    return (
        f"For {names}, `auto` selects `{plain.label}`"
        f" ({1e3 * plain.wall_time:.2g} ms per simulated second).\n"
        "  If `imbalance_acceleration` must meet this error too, `auto` selects"
        f" `{with_acceleration.label}` ({1e3 * with_acceleration.wall_time:.2g} ms)."
    )


def values():
    """Return the values of the template's placeholders."""
    parts = read_measurements()
    speeds, steps = parts[R1], parts["native FMU"]
    shell = parts["shell of the Python FMU"]["time of a step and two reads"]
    urban = parts["urban scene, kernel"]
    torque = parts["averaged, driven by torque"]["omega1, error of averaged"]
    rows = read_rows(HERE / "tradeoff_r1.csv")
    rigid, short, long = (
        urban["time"][name]
        for name in ("rigid, steps of 0.01 s", "averaged, steps of 0.01 s", "averaged, steps of 1 s")
    )
    return {
        "cores": f"{parts['machine']['cores']['all']:.0f}",
        "python": f"{parts['machine']['Python']['all']:g}",
        "table": table(speeds, rows),
        "kernel": speeds["time"][CASES[0]],
        "short": speeds["time"][CASES[1]],
        "short_error": speeds["error"][CASES[1]],
        "peers": "\n".join(peer_lines(rows)),
        "step": steps["time of a step"],
        "worst": steps["worst step"],
        "fmpy": steps["time of a step and two reads through fmpy"],
        "python_fmu": shell["InertiaModulePy"],
        "python_ratio": shell["InertiaModulePy"] / shell["trivial pythonfmu FMU"],
        "start": parts["instantiation"]["time"],
        "page": parts["scene R1 in the page"]["page"],
        "page_ratio": parts["scene R1 in the page"]["ratio"],
        "urban": urban_choice(),
        "averaged_short": rigid / short,
        "averaged_long": rigid / long,
        "averaged_difference": urban["difference of mean output speed"]["averaged against rigid"],
        "light_bevel": torque["bevel, J1 / Phi = 5"],
        "light_planar": torque["planar, J1 / Phi = 5"],
        "heavy_bevel": torque["bevel, J1 / Phi = 50"],
        "heavy_planar": torque["planar, J1 / Phi = 50"],
    }
