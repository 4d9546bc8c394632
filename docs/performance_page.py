"""Figures of docs/performance.md, from the committed tables that `make bench` writes."""

import csv
from pathlib import Path

from inertia_module.fidelity.trials import PEER, read_rows, recommend
from inertia_module.scene import load_scene

HERE = Path(__file__).parent
URBAN = HERE.parent / "examples" / "urban.toml"
R1 = "scene R1 at an error of 1e-6"
WANTED = 1e-6
ERROR = "omega_out_final"
# how the table calls what was measured: names of its cases, and how names of peers begin
OURS = (
    *("kernel, compiled, one step of 1 s", "kernel, compiled, steps of 1 ms"),
    *("C by hand, one step of 1 s", "C by hand, steps of 1 ms"),
    *("native FMU in an fmpy loop, steps of 1 ms", "Python FMU in an fmpy loop, steps of 1 ms"),
    "kernel, plain Python, one step of 1 s",
)
PEERS = ("SciPy", "CVODE", "MuJoCo")


def figures():
    """The table of speed: values by part, quantity and case."""
    found = {}
    with (HERE / "performance.csv").open() as stream:
        for row in csv.DictReader(stream):
            quantities = found.setdefault(row["part"], {}).setdefault(row["quantity"], {})
            quantities[row["case"]] = float(row["value"])
    return found


def fastest(rows, error, allowed):
    """The fastest run within an error, or None."""
    meeting = [row for row in rows if not row.failure and row.errors[error] <= allowed]
    return min(meeting, key=lambda row: row.wall_time, default=None)


def table(measured, rows):
    """A line for each form of the module, for C by hand, and for the fastest run of each peer."""
    kernel = measured["time"][OURS[0]]
    lines = [
        "| run | error | ms per simulated second | right-hand sides | to the kernel |",
        "|---|---|---|---|---|",
    ]
    for case in OURS:
        error, time = measured["error"][case], measured["time"][case]
        count = measured["right-hand sides"][case]
        lines.append(f"| {case} | {error:.0e} | {time:.3g} | {count:.0f} | {time / kernel:.2g} |")
    peers = [row for row in rows if row.fidelity == PEER and not row.failure]
    ours = fastest([row for row in rows if row.fidelity != PEER], ERROR, WANTED)
    for name in PEERS:
        runs = [row for row in peers if row.method.startswith(name)]
        row = fastest(runs, ERROR, WANTED) or min(runs, key=lambda row: row.errors[ERROR])
        cost = f"{1e3 * row.wall_time:.3g} | {row.evaluations:.0f} | {row.wall_time / ours.wall_time:.2g}"
        lines.append(f"| {row.method}, {row.setting} | {row.errors[ERROR]:.0e} | {cost} |")
    return "\n".join(lines)


def peer_lines(rows):
    """How the fastest peer compares with the module within each error, worst over the run."""
    for allowed in (1e-2, 1e-4, WANTED):
        ours, peer = (
            fastest([row for row in rows if (row.fidelity == PEER) is wanted], "omega_out_worst", allowed)
            for wanted in (False, True)
        )
        told = f"{ours.label} is the fastest of the module"
        if peer is not None:
            ratio = peer.wall_time / ours.wall_time
            told += f"; {peer.method}, {peer.setting} takes {ratio:.0f} times as long"
        yield f"- **Within {allowed:.0e}** over the whole second, {told}."


def urban_choice():
    """What fidelity auto chooses for the urban scene at 1 %, with and without the acceleration."""
    rows = read_rows(HERE / "tradeoff_urban.csv")
    outputs = load_scene(URBAN).run.outputs
    plain = recommend(rows, 0.01, outputs).row
    shaken = recommend(rows, 0.01, [*outputs, "imbalance_acceleration"]).row
    names = " and ".join(f"`{name}`" for name in outputs)
    return (
        f"`auto` chooses {plain.label} for {names} ({1e3 * plain.wall_time:.2g} ms per simulated second), and"
        f" {shaken.label} where the acceleration counts too ({1e3 * shaken.wall_time:.2g} ms)."
    )


def values():
    """What the template has places for."""
    found = figures()
    speeds, steps = found[R1], found["native FMU"]
    shell = found["shell of the Python FMU"]["time of a step and two reads"]
    urban = found["urban scene, kernel"]
    torque = found["averaged, driven by torque"]["omega1, error of averaged"]
    rows = read_rows(HERE / "tradeoff_r1.csv")
    rigid, short, long = (
        urban["time"][name]
        for name in ("rigid, steps of 0.01 s", "averaged, steps of 0.01 s", "averaged, steps of 1 s")
    )
    return {
        "cores": f"{found['machine']['cores']['all']:.0f}",
        "python": f"{found['machine']['Python']['all']:g}",
        "table": table(speeds, rows),
        "kernel": speeds["time"][OURS[0]],
        "short": speeds["time"][OURS[1]],
        "short_error": speeds["error"][OURS[1]],
        "peers": "\n".join(peer_lines(rows)),
        "step": steps["time of a step"],
        "worst": steps["worst step"],
        "fmpy": steps["time of a step and two reads through fmpy"],
        "python_fmu": shell["InertiaModulePy"],
        "python_ratio": shell["InertiaModulePy"] / shell["trivial pythonfmu FMU"],
        "start": found["instantiation"]["time"],
        "page": found["scene R1 in the page"]["page"],
        "page_ratio": found["scene R1 in the page"]["ratio"],
        "urban": urban_choice(),
        "averaged_short": rigid / short,
        "averaged_long": rigid / long,
        "averaged_difference": urban["difference of mean output speed"]["averaged against rigid"],
        "light_bevel": torque["bevel, J1 / Phi = 0.5"],
        "light_planar": torque["planar, J1 / Phi = 0.5"],
        "heavy_bevel": torque["bevel, J1 / Phi = 50"],
        "heavy_planar": torque["planar, J1 / Phi = 50"],
    }
