"""Drivetrains as functional mock-up units (FMI 2.0, co-simulation) that need Python and numpy where they run."""

from __future__ import annotations

import hashlib
import importlib
import io
import json
import math
import os
import re
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.assembly.rows import ComplexArray
from torsionnet.atomic import write_bytes
from torsionnet.channels import UNITS
from torsionnet.drivetrain import Drivetrain
from torsionnet.errors import UsageError
from torsionnet.interchange.matrices import state_space
from torsionnet.interchange.modelica_words import written_unit
from torsionnet.interchange.naming import Names
from torsionnet.signals.files.extras import needed
from torsionnet.solve.state_space import active_channels
from torsionnet.solve.triangular import Block, blocks

SLAVE = Path(__file__).with_name("fmu_slave.py")
VERSION = str(importlib.import_module("torsionnet").__version__)  # the package itself is above every layer
STEP = 1e-4
"""Communication step in s where none is given."""
_DATE = re.compile(rb'generationDateAndTime="[^"]*"')
EPOCH = b'generationDateAndTime="1980-01-01T00:00:00Z"'


def write_fmu(drivetrain: Drivetrain, path: str | os.PathLike[str], step: float = STEP) -> None:
    """Write a drivetrain as an FMU for co-simulation, FMI 2.0.

    Inputs of the FMU are the torque inputs of the model in N m, outputs its sensors in SI units. It starts at rest and
    is stepped exactly for inputs that are held from one communication point to the next; there is no other error.

    Parameters
    ----------
    drivetrain : Drivetrain
    path : str or path
        A file ending in .fmu.
    step : float
        Communication step in s. The master may also take whole multiples of it.

    Raises
    ------
    UsageError
        No inputs or sensors, frequency-dependent laws, an imposed angle, a reading with the rate of an input in it, a
        step that is not positive, or another ending.
    MissingExtraError
        pythonfmu is not installed.

    Notes
    -----
    The FMU carries the program library of pythonfmu for Linux and Windows, which looks for an installed Python with
    numpy. Equal drivetrains give equal bytes.

    Examples
    --------
    >>> import tempfile
    >>> import torsionnet as tn
    >>> path = Path(tempfile.mkdtemp(), "rig.fmu")
    >>> write_fmu(tn.load("dmf_rig"), path, step=1e-3)
    >>> "resources/stepping.npz" in zipfile.ZipFile(path).namelist()
    True
    """
    target = Path(path)
    if target.suffix.lower() != ".fmu":
        msg = f'cannot write "{path}": give a file ending in .fmu'
        raise UsageError(msg)
    if not (isinstance(step, int | float) and math.isfinite(step) and step > 0):
        msg = f"the communication step is a positive time in s, got {step}"
        raise UsageError(msg)
    pythonfmu = needed("fmu")
    numbers, about = _stepping(drivetrain, step), _about(drivetrain, step)
    with tempfile.TemporaryDirectory(prefix="torsionnet_") as folder:
        place = Path(folder)
        (place / "stepping.npz").write_bytes(numbers)
        about["guid"] = hashlib.sha256(numbers + json.dumps(about).encode()).hexdigest()[:32]
        (place / "about.json").write_text(json.dumps(about), encoding="utf-8")
        script = place / "torsionnet_slave.py"
        script.write_bytes(SLAVE.read_bytes())
        with _clean_imports(script.stem):
            built = pythonfmu.builder.FmuBuilder.build_FMU(
                script, dest=place / "built.fmu", project_files=[place / "stepping.npz", place / "about.json"]
            )
        write_bytes(target, _dateless(Path(built or place / "built.fmu")))


def _about(drivetrain: Drivetrain, step: float) -> dict[str, Any]:
    present = active_channels(drivetrain)
    if not present.inputs or not present.sensors:
        msg = "an FMU needs at least one input and one sensor in the model"
        raise UsageError(msg)
    return {
        "identifier": Names().new(drivetrain.title),
        "title": drivetrain.title,
        "version": VERSION,
        "step": float(step),
        "inputs": [[name, "N.m"] for name in present.inputs],
        "outputs": [[name, written_unit(UNITS[sensor.quantity])] for name, sensor in present.sensors.items()],
    }


def _stepping(drivetrain: Drivetrain, step: float) -> bytes:
    """The matrices of one step, block by block in a diagonal, as an archive."""
    from scipy.linalg import block_diag

    system = state_space(drivetrain)
    parts = blocks(system.A, system.B, system.C)
    held = [_held(part, step) for part in parts]
    arrays: dict[str, Any] = {
        "step": block_diag(*(stepped for stepped, _ in held)),
        "gain": np.vstack([gain for _, gain in held]),
        "C": np.hstack([part.C for part in parts]),
        "D": system.D,
    }
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def _held(block: Block, h: float) -> tuple[ComplexArray, ComplexArray]:
    """exp(T h), and the integral of exp(T t) B over the step: the response to an input that is held."""
    from scipy.linalg import expm

    n, n_in = block.B.shape
    whole = np.zeros((n + n_in, n + n_in), dtype=complex)
    whole[:n, :n], whole[:n, n:] = block.T * h, block.B * h
    power = np.asarray(expm(whole), dtype=np.complex128)
    return power[:n, :n], power[:n, n:]


@contextmanager
def _clean_imports(module: str) -> Iterator[None]:
    """The builder imports the script from a folder that is soon gone; leave nothing of that behind."""
    path, writes = list(sys.path), sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    try:
        yield
    finally:
        sys.path[:], sys.dont_write_bytecode = path, writes
        sys.modules.pop(module, None)


def _dateless(built: Path) -> bytes:
    """The archive in alphabetical order and without the date of today."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(built) as source, zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as target:
        for name in sorted(source.namelist()):
            content = source.read(name)
            if name == "modelDescription.xml":
                content = _DATE.sub(EPOCH, content)
            target.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
