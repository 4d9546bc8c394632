"""A kernel as LLVM IR for no processor in particular: machine code for every platform is made from it.

It is translated (lowered.py) in a process of its own, whose environment leaves nothing to chance: the same
source gives the same text.
"""

from __future__ import annotations

import importlib.metadata
import lzma
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

from ..common.files import PACKAGE_FOLDER, kept, kept_file, sources
from ..contract.models import Model
from . import CompilationUnavailable

# order of numba's sets, and the processor it takes for the host: what the text would depend on
ENVIRONMENT = {
    **{"PYTHONHASHSEED": "0", "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",  # it colours what it then does not say
}
NEEDED = ("numba", "llvmlite")


def tool_versions(*packages: str) -> dict[str, bytes]:
    """Versions of Python and of packages, by name."""
    versions = {platform.python_implementation(): platform.python_version()}
    for package in packages:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            raise CompilationUnavailable(
                f"{package} is not installed. Run pip install 'inertia-module[fast]'."
            ) from None
    return {name: version.encode() for name, version in versions.items()}


def made_from(model: Model) -> dict[str, bytes]:
    """All that the text depends on: source of the kernel, what translates it, versions of the tools."""
    translator = sources("contract/records.py", "compiling/lowered.py", "compiling/ir.py")
    return model.source | translator | tool_versions(*NEEDED)


def _name(model: Model) -> str:
    return f"{model.name}.ll.xz"


def is_cached(model: Model) -> bool:
    """Tell whether llvm_text will find the text of this source in the cache."""
    return kept_file(_name(model), made_from(model)) is not None


def _translate(model: Model) -> bytes:
    """LLVM IR of a kernel, compressed, translated in a process of its own."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")}
    # the package of this file, wherever it lies
    environment |= ENVIRONMENT | {"PYTHONPATH": str(PACKAGE_FOLDER.parent)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / _name(model)
        command = [sys.executable, "-m", f"{__package__}.lowered", model.name, str(path)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise CompilationUnavailable(f"numba failed: {done.stderr.strip()[-2000:]}")
        return path.read_bytes()


def llvm_text(model: Model) -> str:
    """LLVM IR of a kernel, from the cache or, the first time ever, translated: about a minute."""
    path = kept(_name(model), made_from(model), lambda: _translate(model))
    return lzma.decompress(path.read_bytes()).decode()
