"""Compilation of an FMU's C sources to shared libraries, for many platforms by Zig, or for this one by a C compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from torsionnet.base.errors import MissingExtraError, TorsionnetError
from torsionnet.io.fmu.platforms import PLATFORMS, Platform, this_machine, universal_binary
from torsionnet.signals.formats.extras import import_extra

FLAGS = ("-std=c99", "-O2", "-shared", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno", "-w")
"""Options of the C compiler, without fused products, so that terms that cancel do so alike on every machine."""
COMPILERS = ("cc", "gcc", "clang")
"""Names of C compilers that are looked for, after the one in the environment variable ``CC``."""
COMPILER_TIMEOUT = 600
"""Most seconds that one call of the C compiler may take."""


class CompilerError(TorsionnetError):
    """Error of the C compiler, with its messages."""


def compile_libraries(sources: Mapping[str, str], identifier: str, version: str, folder: Path) -> dict[str, bytes]:
    """Shared libraries made from ``sources`` in an empty ``folder``, by their path in the archive of an FMU.

    Raises
    ------
    MissingExtraError
        There is neither Zig nor a C compiler.
    CompilerError
        The compiler fails.
    """
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="ascii", newline="\n")
    commands = _commands()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = list(pool.map(lambda item: _compiled(item[1], item[0], folder), commands.items()))
    return _placed(dict(zip(commands, made, strict=True)), identifier, version)


def _commands() -> dict[Platform, list[str]]:
    """Command that calls the C compiler, for each platform that a library can be made for."""
    try:
        import_extra("fmu")
    except MissingExtraError as error:
        compiler = _compiler()
        if compiler is None:
            raise MissingExtraError(f"{error}; a C compiler (CC, cc, gcc or clang) would do for this machine") from None
        return {this_machine(): [compiler]}
    zig = [sys.executable, "-m", "ziglang", "cc", "-s", "-target"]
    return {target: [*zig, target.target] for target in PLATFORMS}


def _compiler() -> str | None:
    """Path of the installed C compiler, the one that ``CC`` names first, None if there is none."""
    named = (os.environ.get("CC", ""), *COMPILERS)
    return next((found for name in named if name and (found := shutil.which(name))), None)


def _compiled(command: list[str], platform: Platform, folder: Path) -> bytes:
    environment = {**os.environ, "ZIG_LOCAL_CACHE_DIR": str(folder / f"cache_{platform.name}")}
    library = folder / f"{platform.name}{platform.suffix}"
    position = [] if platform.suffix == ".dll" else ["-fPIC"]
    plain = ["-Wl,--build-id=none"] if platform.suffix == ".so" else []
    call = [*command, *FLAGS, *position, *plain, "-o", library.name, "all.c", "-lm"]
    try:
        done = subprocess.run(
            call, cwd=folder, env=environment, capture_output=True, text=True, errors="replace",
            timeout=COMPILER_TIMEOUT, check=False, stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise CompilerError(f"the C compiler {command[0]} cannot be run: {error}") from None
    if done.returncode or not library.is_file():
        said = done.stderr.strip().splitlines()[-10:]
        raise CompilerError("\n".join([f"the C compiler failed for {platform.name}: {' '.join(call)}", *said]))
    return library.read_bytes()


def _placed(made: Mapping[Platform, bytes], identifier: str, version: str) -> dict[str, bytes]:
    """Shared libraries by their path in the archive of an FMU, those for one folder in one file."""
    together: dict[str, dict[Platform, bytes]] = {}
    for target, library in made.items():
        path = f"binaries/{target.folder(version)}/{identifier}{target.suffix}"
        together.setdefault(path, {})[target] = library
    return {
        path: next(iter(found.values()))
        if len(found) == 1
        else universal_binary({target.name.split("-")[0]: library for target, library in found.items()})
        for path, found in together.items()
    }
