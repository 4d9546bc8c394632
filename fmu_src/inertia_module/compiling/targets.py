"""The platforms for which machine code is compiled."""

from __future__ import annotations

import platform
import sys
from typing import NamedTuple

from . import CompilationError

# endings of the names of shared libraries, by system
SUFFIXES = {"linux": ".so", "windows": ".dll", "macos": ".dylib", "wasi": ".wasm"}


class Target(NamedTuple):
    """A platform.

    Attributes:
        folder: folder of its binary in an FMU of FMI 2.0, below binaries.
        processor: name for zig of the oldest supported processor.
        compiler: name of the target for zig.
        libraries: flags of the linker for libraries in addition to the C library.
    """

    folder: str
    processor: str
    compiler: str
    libraries: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Name of the target in files and messages."""
        return self.compiler.split(".", 1)[0]

    @property
    def system(self) -> str:
        """Name of the operating system for the C compiler."""
        return self.label.split("-")[1]

    @property
    def suffix(self) -> str:
        """Ending of the name of a shared library."""
        return SUFFIXES[self.system]

    @property
    def platform(self) -> str:
        """Name of the platform, and of the folder of its binary, in FMI 3.0."""
        return f"{self.label.split('-')[0]}-{self.system.replace('macos', 'darwin')}"


# oldest processors: x86-64 of 2009, any 64-bit ARM; oldest systems: glibc 2.17 of 2012, macOS 11 of 2020
_V2, _ARM = "x86_64_v2", "generic"
LINUX64 = Target("linux64", _V2, "x86_64-linux-gnu.2.17", ("-lm",))
LINUX_ARM = Target("aarch64-linux", _ARM, "aarch64-linux-gnu.2.17", ("-lm",))
WIN64 = Target("win64", _V2, "x86_64-windows-gnu")
WIN_ARM = Target("aarch64-windows", _ARM, "aarch64-windows-gnu")
MAC64 = Target("darwin64", _V2, "x86_64-macos.11.0")
MAC_ARM = Target("darwin64", "apple_m1", "aarch64-macos.11.0")
# size of the stack, bytes; the deepest calls need 800
_STACK = "-Wl,-z,stack-size=65536"
# all browsers since 2021 support the instructions of the "generic" processor
BROWSERS = Target("", "generic", "wasm32-wasi", (_STACK,))

# all platforms; targets with the same folder share one file with code for several processors
TARGETS = (LINUX64, WIN64, MAC64, MAC_ARM, LINUX_ARM, WIN_ARM)
# names for zig by the names of Python; a processor has several names in Python
SYSTEMS = {"linux": "linux", "win32": "windows", "darwin": "macos"}
PROCESSORS = {"x86_64": "x86_64", "amd64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}


def host_target() -> Target:
    """Return the target of this process.

    Raises:
        CompilationError: the platform is not one of TARGETS.
    """
    own = f"{PROCESSORS.get(platform.machine().lower())}-{SYSTEMS.get(sys.platform)}"
    for target in TARGETS:
        if target.label.startswith(own) and sys.maxsize > 2**32:
            return target
    labels = ", ".join(target.label for target in TARGETS)
    raise CompilationError(f"unsupported platform {platform.machine()}-{sys.platform}; available: {labels}")
