"""Build kernels, FMUs and the kernel of the page, so that the workers of pytest do not wait for them.

Run: python -m tests.ready; `make test` runs it in parallel with the build of the page.
"""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from inertia_module.compiling.load import load
from inertia_module.compiling.targets import TARGETS, here
from inertia_module.fmu.builder import FMUS, WEB_KERNEL, build
from inertia_module.interface.models import MODELS

# targets whose code goes into the library that this process would load: of macOS two
HERE = tuple(target for target in TARGETS if target.folder == here().folder)


def make_ready():
    """Fill the cache, side by side: the work is done in libraries and processes of others."""
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor() as pool:
        tasks = [pool.submit(load, model) for model in MODELS.values()]
        tasks += [
            pool.submit(build, Path(folder), files=files, targets=HERE) for files in (FMUS, (WEB_KERNEL,))
        ]
        for task in tasks:
            task.result()


if __name__ == "__main__":
    make_ready()
