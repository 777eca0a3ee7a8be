"""Platforms that an FMU has binaries for, and their names in its archive."""

from __future__ import annotations

import platform
import struct
from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    """Kind of machine that an FMU has a shared library for.

    Attributes
    ----------
    name : str
        Processor and system; also the folder in FMI 3.0.
    target : str
        Name of the platform for Zig.
    fmi2_folder : str
        The folder of FMI 2.0: it has one for all Macs, and none for Linux on ARM, where the new name has come into use.
    suffix : str
        Ending of a shared library.
    """

    name: str
    target: str
    fmi2_folder: str
    suffix: str

    def folder(self, version: str) -> str:
        """Name of the folder of the platform's binaries in an FMU of this version of FMI."""
        return self.fmi2_folder if version == "2.0" else self.name


PLATFORMS = (
    Platform("x86_64-linux", "x86_64-linux-gnu.2.17", "linux64", ".so"),
    Platform("aarch64-linux", "aarch64-linux-gnu.2.17", "aarch64-linux", ".so"),
    Platform("x86_64-windows", "x86_64-windows-gnu", "win64", ".dll"),
    Platform("x86_64-darwin", "x86_64-macos", "darwin64", ".dylib"),
    Platform("aarch64-darwin", "aarch64-macos", "darwin64", ".dylib"),
)
"""Platforms that Zig compiles an FMU's libraries for."""


def this_machine() -> Platform:
    """Platform (processor and system) that this program runs on."""
    system = {"Windows": "windows", "Darwin": "darwin"}.get(platform.system(), "linux")
    processor = "aarch64" if platform.machine().lower() in ("aarch64", "arm64") else "x86_64"
    return next(
        (known for known in PLATFORMS if known.name == f"{processor}-{system}"),
        Platform(f"{processor}-{system}", "", f"{processor}-{system}", ".dll"),  # Windows on ARM
    )


_ALIGNMENT = 14
"""Binary logarithm of the size in bytes of a memory page on Macs with ARM processors, 16 KiB."""
_PROCESSORS = {"x86_64": (0x01000007, 3), "aarch64": (0x0100000C, 0)}
"""Type and subtype of processors in a universal binary of macOS (``mach/machine.h``)."""


def universal_binary(libraries: Mapping[str, bytes]) -> bytes:
    """Bytes of one macOS library for several processors, a header, then the library of each on pages of its own."""
    page = 1 << _ALIGNMENT
    header, body, start = struct.pack(">II", 0xCAFEBABE, len(libraries)), b"", page
    for processor, library in libraries.items():
        header += struct.pack(">IIIII", *_PROCESSORS[processor], start, len(library), _ALIGNMENT)
        padded = library + bytes(-len(library) % page)
        body, start = body + padded, start + len(padded)
    return header + bytes(page - len(header)) + body
