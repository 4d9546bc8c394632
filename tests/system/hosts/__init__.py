"""Scenes run by several FMI hosts, in processes of their own: one that crashes does not end the tests.

Every host couples its models by the same algorithm, Jacobi's with a fixed step: all step side by side with
the inputs of the communication point, then the outputs are passed on. All set the values of a scene before
the end of initialisation, so that there is no jump at the start.
"""

import dataclasses
import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

# how a host counts time: by adding the step up, or in whole nanoseconds, of which it takes the differences
ACCUMULATED, NANOSECONDS = "accumulated", "nanoseconds"
FMPY = "fmpy"


@dataclasses.dataclass(frozen=True)
class Host:
    """What there is to know about a host.

    Attributes:
        clock: how it counts time. packages: what it needs besides fmpy.
        minds_errors: whether it stops when the FMU refuses something.
    """

    clock: str
    packages: tuple[str, ...] = ()
    minds_errors: bool = True

    @property
    def missing(self):
        """Packages that it needs and that are not installed."""
        return [name for name in self.packages if not _is_installed(name)]


HOSTS = {
    "libcosim": Host(NANOSECONDS, ("libcosimpy",)),
    "ecos": Host(
        ACCUMULATED, ("ecospy", "tbb") if sys.platform == "linux" else ("ecospy",), minds_errors=False
    ),
}


@dataclasses.dataclass(frozen=True)
class Scene:
    """Models to step side by side.

    Attributes:
        models: values (parameters and inputs) by name, by name of the instance, which is that of the FMU or
            that and a number: Module_2.
        step: communication step, s. steps: how many.
        connections: (instance, output, instance, input).
        changes: values of inputs by name, by instance, by the number of the step they are set before.
    """

    models: dict[str, dict[str, float]]
    step: float
    steps: int
    connections: tuple[tuple[str, str, str, str], ...] = ()
    changes: dict[int, dict[str, dict[str, float]]] = dataclasses.field(default_factory=dict)


class HostFailed(RuntimeError):
    """The host ended with an error: what it says."""


def _is_installed(package):
    try:
        importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


def run(host, scenes, work, clock=ACCUMULATED):
    """Run scenes in a host, one after the other in one process.

    Args:
        host: FMPY or one of HOSTS. scenes: by name, each with the folder of its FMUs.
        work: folder for what the host leaves behind. clock: how FMPY is to count time.

    Returns:
        By the name of the scene the outputs after each step, by 'instance.output'.

    Raises:
        HostFailed: the host ends with an error.
    """
    folders = {}
    for number, (name, (scene, folder)) in enumerate(scenes.items()):
        folders[name] = work / str(number)
        folders[name].mkdir(parents=True)
        task = dataclasses.asdict(scene) | {"folder": str(folder), "clock": clock}
        (folders[name] / "task.json").write_text(json.dumps(task))
    done = subprocess.run(
        [sys.executable, str(Path(__file__).parent / f"with_{host}.py"), *map(str, folders.values())],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
        cwd=work,
    )
    if done.returncode != 0:
        raise HostFailed(f"{host} ends with {done.returncode}: {done.stdout[-3000:]}")
    return {name: _outputs(scene, folders[name]) for name, (scene, _) in scenes.items()}


def _outputs(scene, work):
    names = json.loads((work / "names.json").read_text())
    rows = np.load(work / "rows.npy")
    assert rows.shape == (scene.steps, len(names))
    return dict(zip(names, rows.T, strict=True))
