"""C code of a drivetrain's FMU, with sizes, start values, and a function from parameters to all matrices."""

from __future__ import annotations

import os
import platform
import shutil
import struct
import subprocess
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.base.errors import MissingExtraError, TorsionnetError
from torsionnet.base.program import ProgramNode
from torsionnet.io.fmu.traced_matrices import System, Variables
from torsionnet.io.fmu.traced_numbers import NumberTape
from torsionnet.signals.formats.extras import import_extra

HEADER = """/* Sizes of this model. */

#define TN_TOKEN "{token}"
#define TN_H {heavy} /* coordinates with inertia */
#define TN_B {damped} /* massless, with dampers */
#define TN_S {static} /* massless, with springs alone */
#define TN_U {inputs}
#define TN_Y {outputs}
#define TN_P {parameters}
#define TN_Q {derived}
"""
"""Template of ``model.h`` of an FMU, with numbers of coordinates by kind, signals and parameters."""

MODEL = """/* {title}: its matrices, from its parameters in SI units.

   Coordinates: {coordinates}
   Inputs: {inputs}
   Outputs: {outputs} */

#define M(i, j) m->M[(i) * TN_N + (j)]
#define C(i, j) m->C[(i) * TN_N + (j)]
#define K(i, j) m->K[(i) * TN_N + (j)]
#define L(i, j) m->L[(i) * TN_U + (j)]
#define R0(i, j) m->R0[(i) * TN_N + (j)]
#define R1(i, j) m->R1[(i) * TN_N + (j)]
#define R2(i, j) m->R2[(i) * TN_N + (j)]
#define F(i, j) m->F[(i) * TN_U + (j)]

static const double tn_start[] = {{{start}0}};

static void tn_fill(const double *p, double *derived, tn_mechanics *m)
{{
{body}
}}

#undef M
#undef C
#undef K
#undef L
#undef R0
#undef R1
#undef R2
#undef F
"""
"""Template of ``model.c`` of an FMU, with start values of the parameters and the function that fills the matrices."""


def header_source(system: System, variables: Variables, token: str) -> str:
    """Text of ``model.h`` of an FMU, with the sizes of the model and the token."""
    motion = system.motion
    return HEADER.format(
        token=token,
        heavy=len(motion.heavy),
        damped=len(motion.damped),
        static=len(motion.static),
        inputs=len(system.inputs),
        outputs=len(system.outputs),
        parameters=len(variables.open),
        derived=len(variables.derived),
    )


def model_source(system: System, variables: Variables, title: str) -> str:
    """Text of ``model.c`` of an FMU, with start values of the parameters, and the function that fills the matrices."""
    code = _Code(system.motion.tape, {name: number for number, name in enumerate(variables.open)})
    wanted = [*variables.derived.values(), *(v for entries in system.matrices.values() for _, _, v in entries)]
    lines = code.steps(wanted)
    lines += [f"derived[{place}] = {code.name(v)};" for place, v in enumerate(variables.derived.values())]
    for letter, entries in system.matrices.items():
        lines += [f"{letter}({i}, {j}) = {code.name(value)};" for i, j, value in entries]
    return MODEL.format(
        title=_comment(title),
        coordinates=_comment(", ".join(system.coordinates)),
        inputs=_comment(", ".join(system.inputs)),
        outputs=_comment(", ".join(system.outputs)),
        start="".join(f"{literal(value)}, " for value in variables.open.values()),
        body="\n".join(f"    {line}" for line in lines),
    )


class _Code:
    """Names in C of numbers on the tape of calculations; ``numbers`` says where in p a parameter is."""

    def __init__(self, tape: NumberTape, numbers: Mapping[str, int]) -> None:
        self.tape, self.numbers = tape, numbers
        results = (place for place in range(len(tape.steps)) if tape.constant(tape.at(place)) is None)
        self.order = {place: number for number, place in enumerate(results)}

    def steps(self, wanted: Iterable[ProgramNode]) -> list[str]:
        """Lines of C that calculate the numbers on the tape, each once."""
        results = (place for place in self.tape.needed(wanted) if place in self.order)
        return [f"const double {self._place(place)} = {self._operation(place)};" for place in results]

    def _operation(self, place: int) -> str:
        sign, *operands = self.tape.steps[place]
        if sign == "leaf":
            return f"p[{self.numbers[operands[0].name]}]"
        numbers = [self.tape.at(operand) for operand in operands]
        if sign == "sqrt":
            return f"sqrt({self.name(*numbers)})"
        left, right = numbers if sign == "/" else sorted(numbers, key=self._rank)
        return f"{self.name(left)} {sign} {self.name(right)}"

    def _rank(self, number: ProgramNode) -> tuple[int, Any]:
        """Sort key of a number in a sum or product, constants first."""
        return (1, self.order[number.index]) if number.index in self.order else (0, number.value)

    def name(self, number: ProgramNode) -> str:
        """Text in C of a number on the tape, the variable that holds it, or the literal of a constant."""
        return self._place(number.index) if number.index in self.order else literal(float(number.value))

    def _place(self, place: int) -> str:
        sign, *operands = self.tape.steps[place]
        if sign != "leaf":
            return f"v{self.order[place]}"
        # The number tells left.k from left_k.
        name = operands[0].name
        return f"p{self.numbers[name]}_{name.replace('.', '_')}" if "." in name else f"p_{name}"


def literal(value: float) -> str:
    """Text of a double-precision number in C, to the last digit.

    >>> literal(460.0), literal(-0.1)
    ('460.0', '(-0.1)')
    """
    return f"({value!r})" if value < 0 else repr(float(value))


def _comment(text: str) -> str:
    """Text for a C comment, on one line, in ASCII, and without what would end the comment."""
    plain = " ".join(text.split()).encode("ascii", "replace").decode()
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("\\", "/").replace("??", "? ?")


# Platforms that an FMU has binaries for, and their names in its archive.


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


# Compilation of an FMU's C sources to shared libraries, for many platforms by Zig, or for this one by a C compiler.

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
    return next((compiler for name in named if name and (compiler := shutil.which(name))), None)


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
        raise CompilerError(f"the C compiler {command[0]} cannot be run: {error}", kind="failed-program") from None
    if done.returncode or not library.is_file():
        said = done.stderr.strip().splitlines()[-10:]
        text = "\n".join([f"the C compiler failed for {platform.name}: {' '.join(call)}", *said])
        raise CompilerError(text, kind="failed-program")
    return library.read_bytes()


def _placed(made: Mapping[Platform, bytes], identifier: str, version: str) -> dict[str, bytes]:
    """Shared libraries by their path in the archive of an FMU, those for one folder in one file."""
    together: dict[str, dict[Platform, bytes]] = {}
    for target, library in made.items():
        path = f"binaries/{target.folder(version)}/{identifier}{target.suffix}"
        together.setdefault(path, {})[target] = library
    return {
        path: next(iter(libraries.values()))
        if len(libraries) == 1
        else universal_binary({target.name.split("-")[0]: library for target, library in libraries.items()})
        for path, libraries in together.items()
    }
