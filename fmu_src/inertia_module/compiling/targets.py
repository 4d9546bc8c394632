"""The platforms that machine code is made for."""

from __future__ import annotations

import platform
import sys
from typing import NamedTuple

from . import CompilationUnavailable


class Target(NamedTuple):
    """A platform: how LLVM and the C compiler call it, and where an FMU keeps its binary.

    Attributes:
        folder: in an FMU of FMI 2.0, below binaries. suffix: of the shared library.
        triple, processor: for the machine code of the kernel. compiler: target of the C compiler.
        libraries: what is linked with besides the C library.
        import_machine: on Windows, how the maker of import libraries calls the processor.
        features: what the processor can do beyond its name, as LLVM writes it.
    """

    folder: str
    suffix: str
    triple: str
    processor: str
    compiler: str
    libraries: tuple[str, ...] = ()
    import_machine: str = ""
    features: str = ""

    @property
    def platform(self) -> str:
        """Name of the platform, and so of the folder, in FMI 3.0."""
        processor, system = self.compiler.split(".", 1)[0].split("-")[:2]
        return f"{processor}-{system.replace('macos', 'darwin')}"

    @property
    def label(self) -> str:
        """Name of the target in files and messages."""
        return self.compiler.split(".", 1)[0]


# processors: any x86-64 since 2009, any 64-bit ARM; systems: glibc 2.17 is of 2012, macOS 11 of 2020
_V2 = "x86-64-v2"
LINUX64 = Target("linux64", ".so", "x86_64-unknown-linux-gnu", _V2, "x86_64-linux-gnu.2.17", ("-lm",))
WIN64 = Target(
    "win64", ".dll", "x86_64-pc-windows-msvc", _V2, "x86_64-windows-gnu", import_machine="i386:x86-64"
)
LINUX_ARM = Target(
    "aarch64-linux", ".so", "aarch64-unknown-linux-gnu", "generic", "aarch64-linux-gnu.2.17", ("-lm",)
)
WIN_ARM = Target(
    "aarch64-windows",
    ".dll",
    "aarch64-pc-windows-msvc",
    "generic",
    "aarch64-windows-gnu",
    import_machine="arm64",
)
MAC64 = Target("darwin64", ".dylib", "x86_64-apple-macosx11.0", _V2, "x86_64-macos.11.0")
MAC_ARM = Target("darwin64", ".dylib", "arm64-apple-macosx11.0", "apple-m1", "aarch64-macos.11.0")

# those of one folder go into one file that holds code for several processors
TARGETS = (LINUX64, WIN64, MAC64, MAC_ARM, LINUX_ARM, WIN_ARM)
# by the names of Python; processors have several
SYSTEMS = {"linux": "linux", "win32": "windows", "darwin": "macos"}
PROCESSORS = {"x86_64": "x86_64", "amd64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}


def here() -> Target:
    """Target of this process.

    Raises:
        CompilationUnavailable: it is none of TARGETS.
    """
    own = f"{PROCESSORS.get(platform.machine().lower())}-{SYSTEMS.get(sys.platform)}"
    for target in TARGETS:
        if target.label.startswith(own) and sys.maxsize > 2**32:
            return target
    known = ", ".join(target.label for target in TARGETS)
    raise CompilationUnavailable(f"there is machine code for {known}, not for {sys.platform} here")
