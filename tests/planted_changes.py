"""Plant single changes in copies of the package, and run tests with each: do the tests fail?

    python tests/planted_changes.py -n 2                     all changes, each with the selection below
    python tests/planted_changes.py -k "^scene/loads"        changes of one file
    python tests/planted_changes.py -k events/location tests/unit/test_events.py

Prints for each change the first test that failed, or "survived". The tests have few examples each. A changed
kernel takes seconds to compile and a changed FMU to build, so choose tests of the kernel without built FMUs.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "fmu_src" / "inertia_module"
TIME_LIMIT = 400  # s per change; an endless run counts as a failure
QUIETLY = {"capture_output": True, "text": True}
# Tests by changed file, and groups of tests.
TESTS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
# File of the package, and a unique place in the file: {original text|planted text}.
CHANGES = Path(__file__).with_suffix(".txt").read_text(encoding="utf-8").splitlines()


def edited(change):
    """Return the path of a changed file in the package, and its text with the change."""
    path, place = change.encode().decode("unicode_escape").split(": ", 1)
    old, new = (re.sub(r"{(.*?)\|(.*?)}", part, place) for part in (r"\1", r"\2"))
    source = (PACKAGE / path).read_text(encoding="utf-8")
    assert source.count(old) == 1, f"{path} has {old!r} {source.count(old)} times, must have it once"
    return path, source.replace(old, new)


def planted(folder, change):
    """Copy the package into a folder with this change, and return the folder."""
    path, source = edited(change)
    package = shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    (package / path).write_text(source, encoding="utf-8")
    (package / "examples").symlink_to(ROOT / "examples")
    return folder


def tests_of(change):
    """Return the tests selected for a change by its file."""
    file = change.partition(":")[0]
    names = next(names for part, names in TESTS["selection"].items() if re.search(part, file))
    return [f"tests/{name}" for name in names.format_map(TESTS["groups"]).split()]


def noticed_by(change, selection):
    """Return the first test that fails with a change, or "survived"; nothing is planted without a change."""
    with tempfile.TemporaryDirectory() as folder:
        place = planted(Path(folder), change) if change else PACKAGE.parent
        environment = os.environ | {"PYTHONPATH": str(place)}
        options = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "--hypothesis-profile=few"]
        command = [sys.executable, "-m", "pytest", *options, *selection]
        try:
            done = subprocess.run(
                command, cwd=ROOT, env=environment, timeout=TIME_LIMIT, check=False, **QUIETLY
            )
        except subprocess.TimeoutExpired:
            return f"no end within {TIME_LIMIT} s"
    if done.returncode == 0:
        return "survived"
    first = re.search(r"^(?:FAILED|ERROR) (?:tests/)?(\S.*?)(?: - |$)", done.stdout, re.M)
    if first:
        return first[1]
    return f"no test, but status {done.returncode}: {(done.stdout + done.stderr)[-300:]}"


def main():
    """Run the tests without a change, then with each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tests", nargs="*", help="in place of the selection")
    parser.add_argument("-n", type=int, default=1, help="changes at a time")
    parser.add_argument("-k", default="", help="only changes of files whose path matches this expression")
    arguments = parser.parse_args()
    changes = [change for change in CHANGES if re.search(arguments.k, change.partition(":")[0])]
    chosen = [tuple(arguments.tests or tests_of(change)) for change in changes]
    survivors = 0
    with ThreadPoolExecutor(arguments.n) as pool:
        for before in pool.map(lambda tests: noticed_by("", tests), set(chosen)):
            if before != "survived":
                sys.exit(f"without a change fails {before}")
        for change, result in zip(changes, pool.map(noticed_by, changes, chosen), strict=True):
            print(f"{change:<70} {result}", flush=True)
            survivors += result == "survived"
    print(f"{len(changes) - survivors} of {len(changes)} noticed")


if __name__ == "__main__":
    main()
