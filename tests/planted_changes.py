"""Do the tests notice? Single changes are planted in copies of the kernel, and tests run with each.

    python tests/planted_changes.py                          the selection below, all changes
    python tests/planted_changes.py -n 2 -k search tests/unit/test_dips.py

Prints for each change the first test that failed, or "survived". Nothing is translated: the tests run with
INERTIA_MODULE_KERNEL=plain, so choose tests of the kernel itself, tests/unit, not of built FMUs.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "fmu_src" / "inertia_module"
TIME_LIMIT = 1200  # s a change: an endless run is noticed too
# what is quick in plain Python, that which notices most first
SELECTION = ["test_works", "test_links"]
# file of the kernel, and a place in it that is there once: {what stands there|what is planted}
CHANGES = r"""
links.py: drive {+|-} coupling * push) / determinant\n    return
links.py: {-|+} 0.5 * i2 * rate_q * omega1 * omega1\n
links.py: k * (b1 + {2.0|1.0} * k * g1) * rate_q * alpha1
contact.py: return value >= -zero and rate {>|<} 0.0
contact.py: load == 0.0 and load_rate {>=|>} 0.0
contact.py: TORQUE_ROUNDING = {1e-13|1e-5}
guards.py: x.omega3 {-|+} slowing * t - omega2
guards.py: w.load + d.J3 * alpha2, {|-}d.J3 * jerk2
search.py: SHARE = {0.4|0.0}
search.py: DIP_LOOKS = {30|1}
search.py: if not value < {-zero|0.0}:\n            found
works.py: (start1 + {0.5|1.0} * alpha1 * passed)
works.py: d.friction * omega4 {-|+} balancing
works.py: GAUSS_WEIGHT_1 = 0.11846{3|4}
works.py: sigma < 0.0 or NODES[n] {<=|>=} end:
engine.py: if passed {>=|>} remaining:
engine.py: x.step_size {*|/}= STALLED
engine.py: w.load = {x.load_torque|abs(x.load_torque)}
solvers/explicit.py: turned1 {-|+} change_q / d.k, integrated
solvers/explicit.py: SAFETY * error ** ({-|}1.0 / order)
solvers/dormand_prince.py: 0.20136540080403034, 0.0447{1|2}
solvers/link_step.py: given * (mean_coupling * turned {-|+} 0.5 * (before + after))
solvers/timestepping.py: lost {-|+}= d.balancer * d.J4 * (w.seen3
solvers/elastic_stages.py: (g1 * k * k {-|+} i1) * omega1
averaged/rates.py: 2.0 * speed * torque {-|+} omega3 * torque1
averaged/step.py: h * (d0 - d1) / {12.0|6.0}
averaged/run.py: 1.0 {+|-} share * share / 12.0
impulse.py: impulse * (x.omega1 {+|-} 0.5 * jump)
impulse.py: fraction = {|0.5 * }omega2 / -change
outputs.py: housing = output {-|+} mesh
step.py: x.output_square / h {-|+} mean * mean
inertia.py: (s * s {+|-} 3.0) * radial1) * sin_a
inertia.py: 2.0 * (z1 * z1 {+|-} z * z2)
layout.py: {+|-} coriolis * y1
derive.py: 1.0 + 2.0 * s * {cosine|sine} + s * s
""".strip().splitlines()


def planted(folder, change):
    """Copy the package into a folder with this change made. Returns the folder."""
    path, place = change.encode().decode("unicode_escape").split(": ", 1)
    old, new = (re.sub(r"{(.*?)\|(.*?)}", part, place) for part in (r"\1", r"\2"))
    package = shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    source = (package / "kernel" / path).read_text()
    assert source.count(old) == 1, f"{path} has {old!r} {source.count(old)} times, must have it once"
    (package / "kernel" / path).write_text(source.replace(old, new))
    return folder


def noticed_by(change, selection):
    """First test that fails with a change, or "survived"."""
    with tempfile.TemporaryDirectory() as folder:
        place = planted(Path(folder), change) if change else PACKAGE.parent
        environment = os.environ | {"INERTIA_MODULE_KERNEL": "plain", "PYTHONPATH": str(place)}
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *selection]
        try:
            done = subprocess.run(
                command,
                cwd=ROOT,
                env=environment,
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return f"no end within {TIME_LIMIT} s"
    if done.returncode == 0:
        return "survived"
    first = re.search(r"^(?:FAILED|ERROR) (?:tests/)?(\S.*?)(?: - |$)", done.stdout, re.M)
    return (
        first[1] if first else f"no test, but status {done.returncode}: {(done.stdout + done.stderr)[-300:]}"
    )


def main():
    """Run the tests without a change, then with each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tests", nargs="*", default=[f"tests/unit/test_{name}.py" for name in SELECTION])
    parser.add_argument("-n", type=int, default=1, help="changes at a time")
    parser.add_argument("-k", default="", help="only changes of files whose name contains this")
    arguments = parser.parse_args()
    before = noticed_by(None, arguments.tests)
    if before != "survived":
        sys.exit(f"without a change fails {before}")
    changes = [change for change in CHANGES if arguments.k in change.partition(":")[0]]
    survivors = 0
    with ThreadPoolExecutor(arguments.n) as pool:
        results = pool.map(lambda change: noticed_by(change, arguments.tests), changes)
        for change, found in zip(changes, results, strict=True):
            print(f"{change:<70} {found}", flush=True)
            survivors += found == "survived"
    print(f"{len(changes) - survivors} of {len(changes)} noticed")


if __name__ == "__main__":
    main()
