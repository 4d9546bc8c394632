"""Speed of the native FMU's kernel against the same algorithm written by hand in C (hand_written/).

Fidelity rigid, method event. The C is compiled with -O3 by each compiler found: for the processors the FMU is made for,
and for this one with products fused into sums, which rounds differently (the kernel does not fuse: it has to round as
plain Python does). Results and counts are compared before anything is timed. Run: python benchmarks/hand_written.py
"""

import ctypes
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from array import array
from pathlib import Path

from rich.progress import track

from inertia_module.entries import ENTRIES, MODULE, SIGNATURE
from inertia_module.fmu.builder import MODULE_FMU
from inertia_module.fmu.native_fmu import library
from inertia_module.fmu.targets import LINUX64
from inertia_module.kernel import codes
from inertia_module.module import Module
from inertia_module.records import place

SOURCE = Path(__file__).parent / "hand_written"
ZIG = [sys.executable, "-m", "ziglang", "cc", "-fno-sanitize=undefined"]
COMPILERS = {"gcc": ["gcc"], "zig cc": ZIG}
FLAGS = ["-O3", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-shared", "-fPIC"]
UNFUSED = "-ffp-contract=off"
FUSED = "-ffp-contract=fast"
SAME, THIS_FUSED = "C for the FMU's processors", "C for this processor, fused"
TARGETS = {
    SAME: {"gcc": ["-march=x86-64-v2", UNFUSED], "zig cc": ["-mcpu=x86_64_v2", UNFUSED]},
    THIS_FUSED: {"gcc": ["-march=native", FUSED], "zig cc": ["-mcpu=native", FUSED]},
}
R1 = {"omega1": 100.0, "load_torque": 10.0}
PLANAR = {
    **{
        "layout": 1,
        "sun_radius": 0.05,
        "satellite_radius": 0.03,
        "eccentricity": 0.02,
        "imbalance_mass": 0.8,
    },
    **{"satellites": 3, "link2_inertia": 0.003, "output_inertia": 0.4, "omega1": 120.0, "load_torque": 8.0},
}
# scenes whose results must agree: layouts, satellites, freewheels left out, a load that pulls, ramps
SCENES = {
    "R1": R1,
    "planar, three satellites": PLANAR,
    "two satellites": {**R1, "satellites": 2},
    "three satellites": {**R1, "satellites": 3},
    "no housing freewheel": {**R1, "housing_freewheel": 0},
    "no output freewheel": {**R1, "output_freewheel": 0},
    "heavy load": {**R1, "load_torque": 60.0},
    "load that pulls": {**R1, "load_torque": -5.0},
}
# speeds after the start: jumps (input_hold 0) or ramps (1)
DRIVES = {"R1, jumps of omega1": 0, "R1, ramps of omega1": 1}
# relative; fused products round differently, which grows where the motion is chaotic: then R1 only is compared
AGREEMENT = 1e-9
R1_AGREEMENT = 1e-12
EVALUATIONS_AGREEMENT = 1e-3
ROUNDS = 21
BATCH = 0.01  # s
CASES = ((1.0, 1.0), (10.0, 10.0), (1.0, 1e-3), (10.0, 1e-3))  # simulated time and communication step, s


def build(folder):
    """Libraries of the hand-written C by compiler and target, the FMU's, and the loop that calls an entry."""
    numbers = {name: value for name, value in vars(codes).items() if type(value) is int}
    for letter, record in zip("PDUXY", ENTRIES[MODULE].records, strict=False):
        names = [field if isinstance(field, str) else field[0] for field in record]
        numbers |= {f"{letter}_{name.upper()}": place(record, name) for name in names}
    (folder / "slots.h").write_text("".join(f"#define {name} {value}\n" for name, value in numbers.items()))
    libraries = {}
    for compiler, command in COMPILERS.items():
        if shutil.which(command[0]) is None:
            continue
        for target, options in TARGETS.items():
            path = folder / f"{len(libraries)}.so"
            paths = [f"-I{folder}", str(SOURCE / "rigid.c"), "-o", str(path), "-lm"]
            subprocess.run([*command, *FLAGS, *options[compiler], *paths], check=True)
            libraries[compiler, target] = ctypes.CDLL(str(path))
    path = folder / "loop.so"
    subprocess.run([*command, *FLAGS, str(SOURCE / "loop.c"), "-o", str(path)], check=True)
    fmu = folder / "fmu.so"
    fmu.write_bytes(library(MODULE_FMU, LINUX64))
    Kernel.entry_of_fmu = SIGNATURE(("inertia_module_kernel", ctypes.CDLL(str(fmu))))
    return libraries, ctypes.CDLL(str(path)).loop


class Kernel:
    """An instance stepped by one entry: the FMU's or, given a library, the hand-written one."""

    entry_of_fmu = None

    def __init__(self, loop, parameters, by_hand=None):
        self.loop = loop
        self.module = Module("compiled").start(**parameters)
        self.arrays = [array("d", bytes(record)) for record in self.module._records]
        if by_hand is None:
            self.entry = self.entry_of_fmu
        else:
            by_hand.instance_size.restype = ctypes.c_int64
            self.arrays[3] = array("d", bytes(8 * by_hand.instance_size()))
            self.entry = SIGNATURE(("call", by_hand))
        self.addresses = [ctypes.c_void_p(values.buffer_info()[0]) for values in self.arrays]
        self.pointer = ctypes.cast(self.entry, ctypes.c_void_p)
        if by_hand is not None:
            self.entry(codes.START, *self.addresses, 0.0)
        self.begin = self.arrays[3].tobytes()

    def restore(self):
        ctypes.memmove(self.addresses[3], self.begin, len(self.begin))

    def set(self, **values):
        for name, value in values.items():
            self.arrays[2][self.module.model.place(name)] = value

    def advance(self, h, steps=1):
        if steps == 1:
            status = self.entry(codes.STEP, *self.addresses, h)
        else:
            status = self.loop(
                self.pointer,
                ctypes.c_int64(codes.STEP),
                *self.addresses,
                ctypes.c_double(h),
                ctypes.c_int64(steps),
            )
        if status != codes.OK:
            raise RuntimeError(f"a step of {h} s is refused with status {status}")

    def __getitem__(self, name):
        return self.arrays[4][self.module.model.place(name)]

    def outputs(self):
        return list(self.arrays[4])

    def batch(self, h, steps, calls):
        """Wall time of one of some calls, s; bringing the state back is not counted."""
        total = 0.0
        for _ in range(calls):
            self.restore()
            start = time.perf_counter()
            self.advance(h, steps)
            total += time.perf_counter() - start
        return total / calls


def compare(name, ours, theirs):
    """Largest difference of the outputs, each against its own size. Raises if it is no rounding error."""
    for count in ("contact_switches", "contact_mode"):
        if ours[count] != theirs[count]:
            raise RuntimeError(f"{name}: {count} {theirs[count]} differs from the kernel's {ours[count]}")
    evaluations = ours["rhs_evaluations"], theirs["rhs_evaluations"]
    if abs(evaluations[0] - evaluations[1]) > EVALUATIONS_AGREEMENT * evaluations[0]:
        raise RuntimeError(
            f"{name}: rhs_evaluations {evaluations[1]} differ from the kernel's {evaluations[0]}"
        )
    largest = 0.0
    energy = max(abs(ours["energy_in"]), 1.0)
    for variable in ours.module.model.with_causality("output", "local"):
        a, b = ours[variable.name], theirs[variable.name]
        if variable.name in ("rhs_evaluations", "contact_mode"):
            continue
        scale = energy if variable.name.startswith("energy") else max(abs(a), 1.0)
        difference = abs(a - b) / scale
        close = R1_AGREEMENT if name.startswith("R1 (") and variable.name == "omega_out" else AGREEMENT
        if not difference <= close:
            raise RuntimeError(f"{name}: {variable.name} {b!r} differs from the kernel's {a!r}")
        largest = max(largest, difference)
    return largest, evaluations


def check(libraries, loop):
    """Compare every library with the kernel in every scene. Returns rows for people."""
    rows = []
    for (compiler, target), by_hand in libraries.items():
        label = f"{compiler}, {target}"
        fused = target == THIS_FUSED
        for name, parameters in {"R1": R1}.items() if fused else SCENES.items():
            for h, steps in ((1.0, 1), (1e-3, 1000)):
                pair = [Kernel(loop, parameters, which) for which in (None, by_hand)]
                for kernel in pair:
                    kernel.advance(h, steps)
                rows.append((f"{name}, {h:g} s, {label}", *compare(f"{name} ({label})", *pair)))
        for name, hold in {}.items() if fused else DRIVES.items():
            pair = [Kernel(loop, {**R1, "input_hold": hold}, which) for which in (None, by_hand)]
            for kernel in pair:
                for n in range(100):
                    kernel.set(omega1=100.0 + (n % 7) - 0.2 * n)
                    kernel.advance(0.01)
            rows.append((f"{name}, {label}", *compare(f"{name} ({label})", *pair)))
    return rows


def measure(libraries, loop, tolerance, simulated, h):
    """One case: medians of wall times, s per simulated second, and of the ratios of each round."""
    parameters = {**R1, "tolerance": tolerance}
    kernel = Kernel(loop, parameters)
    by_hand = {name: Kernel(loop, parameters, made) for name, made in libraries.items()}
    steps = round(simulated / h)
    calls = max(1, round(BATCH / kernel.batch(h, steps, 3)))
    rounds = []
    for _ in range(ROUNDS):
        ours = kernel.batch(h, steps, calls)
        rounds.append((ours, {name: run.batch(h, steps, calls) for name, run in by_hand.items()}))
    times = {name: statistics.median(others[name] for _, others in rounds) / simulated for name in libraries}
    fastest = {
        target: min((name for name in libraries if name[1] == target), key=times.get) for target in TARGETS
    }
    return {
        "tolerance": tolerance,
        "simulated": simulated,
        "step": h,
        "evaluations": kernel["rhs_evaluations"],
        "kernel": statistics.median(ours for ours, _ in rounds) / simulated,
        "by_hand": {
            target: {
                "compiler": name[0],
                "time": times[name],
                "ratio": statistics.median(ours / others[name] for ours, others in rounds),
                "evaluations": by_hand[name]["rhs_evaluations"],
            }
            for target, name in fastest.items()
        },
    }


def sufficient_tolerance(wanted=1e-6):
    """Loosest of some tolerances whose error in omega_out of R1 at 1 s stays below the one wanted."""
    exact = omega_out(1e-13)
    ladder = [10.0 ** (-n / 4) for n in range(16, 40)]
    return next(t for t in ladder if abs(omega_out(t) / exact - 1.0) <= wanted)


def omega_out(tolerance):
    module = Module("compiled").start(tolerance=tolerance, **R1)
    module.advance(1.0)
    return module["omega_out"]


def results():
    """(rows of the comparison, measured cases)."""
    with tempfile.TemporaryDirectory() as folder:
        libraries, loop = build(Path(folder))
        rows = check(libraries, loop)
        cases = [(tolerance, *case) for tolerance in (1e-6, sufficient_tolerance()) for case in CASES]
        return rows, [measure(libraries, loop, *case) for case in track(cases, "measuring by hand")]


def section():
    """Markdown of this part of docs/performance.md."""
    rows, found = results()
    worst = max(row[1] for row in rows)
    counted = sum(row[2][0] == row[2][1] for row in rows)
    heads = ("tolerance", "simulated s", "step s", "evaluations", "native FMU", *TARGETS)
    return [
        "## Against C written by hand",
        "",
        "The same algorithm, fidelity rigid, method event, written by hand in C (`benchmarks/hand_written`) and"
        " compiled with -O3 by gcc and by clang, whichever is faster: for the processors that the FMU is made"
        " for, and for this very one with products fused into sums, which the kernel must not do, for it rounds"
        f" as plain Python does. Results agree in {len(rows)} runs (largest relative difference {worst:.1e}); the"
        f" number of evaluations is the same in {counted} of them.",
        "",
        f"R1, us per simulated second, medians of {ROUNDS} rounds in turns; in brackets the ratio of the FMU's"
        " kernel to the C. The second tolerance is the loosest with an error below 1e-6 in `omega_out` at 1 s.",
        "",
        "| " + " | ".join(heads) + " |",
        "|---" * len(heads) + "|",
        *(_row(row) for row in found),
        "",
    ]


def _row(row):
    by_hand = (
        f"{one['time'] * 1e6:.0f} {one['compiler']} ({one['ratio']:.2f})" for one in row["by_hand"].values()
    )
    numbers = f"{row['tolerance']:.1e} | {row['simulated']:g} | {row['step']:g} | {row['evaluations']:.0f}"
    return f"| {numbers} | {row['kernel'] * 1e6:.0f} | " + " | ".join(by_hand) + " |"


if __name__ == "__main__":
    print("\n".join(section()))
