"""Build kernels, FMUs and the kernel of the page, so that the workers of pytest do not wait.

Run: python -m tests.ready; `make test` runs it in parallel with the build of the page.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from inertia_module.compiling.load import load
from inertia_module.compiling.targets import TARGETS, host_target
from inertia_module.fmu.builder import FMUS, WEB_KERNEL, build
from inertia_module.interface.models import MODELS

# Targets whose code belongs to the library of this process: macOS has two.
HERE = tuple(target for target in TARGETS if target.folder == host_target().folder)


def make_ready():
    """Fill the cache in parallel; libraries and other processes do the work."""
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor() as pool:
        tasks = [pool.submit(load, model) for model in MODELS.values()]
        tasks += [
            pool.submit(build, Path(folder), files=files, targets=HERE) for files in (FMUS, (WEB_KERNEL,))
        ]
        for task in tasks:
            task.result()


if __name__ == "__main__":
    make_ready()
