"""Export of a drivetrain's matrices to Matlab and Octave, as a script, or a MAT file with the same variables."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.base.atomic import write_bytes, write_text
from torsionnet.base.errors import UsageError, warn_user
from torsionnet.drivetrain import Drivetrain
from torsionnet.io.export_losses import export_losses, refuse_laws_of_motion
from torsionnet.linear.assembly.law_stiffness import Functional, powers_of_s
from torsionnet.linear.assembly.rows import Assembly, FloatArray, refuse_actions
from torsionnet.linear.dynamic_stiffness.state_space import StateSpace, active_channels, state_space
from torsionnet.signals.formats.mat import cell_array, mat_bytes

# Constant matrices of second order (M, C, K, inputs, outputs) of a drivetrain, as other programs take them.


@dataclass(frozen=True)
class Matrices:
    """Matrices of a drivetrain's equations of motion with inputs and outputs, in SI.

        M q'' + C q' + K q = F u,    y = Y0 q + Y1 q' + Y2 q'' + Yu u,    theta = T q

    Attributes
    ----------
    M, C, K : (n_q, n_q) arrays
        kg m^2, N m s/rad, N m/rad.
    F : (n_q, n_in) array
        Generalised torque of each input, 1.
    Y0, Y1, Y2 : (n_out, n_q) arrays
    Yu : (n_out, n_in) array
    T : (n_nodes, n_q) array
        Angles of all nodes from the coordinates.
    coordinates, nodes, inputs, outputs, input_units, output_units : tuple of str
    """

    M: FloatArray
    C: FloatArray
    K: FloatArray
    F: FloatArray
    Y0: FloatArray
    Y1: FloatArray
    Y2: FloatArray
    Yu: FloatArray
    T: FloatArray
    coordinates: tuple[str, ...]
    nodes: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]


def matrices(drivetrain: Drivetrain) -> Matrices:
    """Matrices in SI of the equations of motion of a drivetrain, with its torque inputs and its sensors.

    Raises
    ------
    UsageError
        A stiffness that depends on frequency, or an input that imposes an angle.

    Examples
    --------
    >>> import torsionnet as tn
    >>> system = matrices(tn.load("dmf_rig"))
    >>> system.coordinates, system.K.tolist(), system.F.tolist()
    (('motor', 'primary'), [[13300.0, -13300.0], [-13300.0, 13760.0]], [[1.0], [0.0]])
    """
    assembly, system = drivetrain.assembly, drivetrain.assembly.system
    present = active_channels(drivetrain)
    _refuse(drivetrain, assembly)
    loads = [assembly.rows_of(channel.row)[0] for channel in present.inputs.values()]
    readings = present.readings(drivetrain)
    n, n_in = system.n_coordinates, len(loads)
    motion = np.array([_motion(assembly, reading) for reading in readings]).reshape(len(readings), 3, n)
    direct = [[float(reading.direct(channel.row)) for channel in present.inputs.values()] for reading in readings]
    return Matrices(
        system.M, system.C, system.K, np.array(loads).reshape(n_in, n).T, motion[:, 0], motion[:, 1], motion[:, 2],
        np.array(direct).reshape(len(readings), n_in), assembly.T, assembly.kinematics.coordinates, assembly.nodes,
        tuple(present.inputs), tuple(present.sensors), ("N*m",) * n_in, tuple(reading.unit for reading in readings),
    )  # fmt: skip


def _refuse(drivetrain: Drivetrain, assembly: Assembly) -> None:
    refuse_actions(assembly.system.actions, "constant matrices are")
    dynamic = sorted({assembly.owners[index] for index, _ in assembly.system.dynamic})
    if dynamic:
        raise UsageError(
            f"{', '.join(dynamic)}: a stiffness that depends on frequency has no place in constant matrices",
            kind="no-counterpart",
        )
    imposed = [name for name, channel in drivetrain.inputs.items() if channel.quantity != "torque"]
    if imposed:
        raise UsageError(
            f"{', '.join(imposed)} imposes an angle; constant matrices have only torques as inputs: make it one",
            kind="no-counterpart",
        )


def _motion(assembly: Assembly, reading: Functional) -> FloatArray:
    """Coefficients (3, n_q) in SI of q, q' and q'' in a sensor's reading."""
    coefficients = np.zeros((3, assembly.system.n_coordinates))
    for term in reading.terms:
        factors = [float(factor) for factor in powers_of_s(assembly, term)]
        coefficients += np.outer(factors, float(term.factor) * term.row)
    return coefficients


MATRIX_MEANINGS = {
    "M": "inertia, kg*m^2",
    "C": "viscous damping, N*m*s/rad",
    "K": "stiffness, N*m/rad",
    "F": "inputs to torques on the coordinates",
    "Y0": "outputs from q",
    "Y1": "outputs from q'",
    "Y2": "outputs from q''",
    "Yu": "outputs from u",
    "T": "angles of all nodes from q",
}
"""Matrices that are exported to Matlab, by name, with the comment on each (meaning, unit) in the script."""
NAME_MEANINGS = {
    "coordinates": "q",
    "nodes": "theta",
    "inputs": "u",
    "input_units": "",
    "outputs": "y",
    "output_units": "",
}
"""Lists of names that are exported to Matlab, with the vector whose entries each list names."""
RESERVED_WORDS = frozenset({
    "break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global", "if",
    "otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "while", "do", "until", "endfor",
    "endfunction", "endif", "endswitch", "endwhile", "end_try_catch", "end_unwind_protect", "unwind_protect",
    "unwind_protect_cleanup", "enumeration", "events", "methods", "properties",
})  # fmt: skip
"""Reserved words of Matlab and Octave, neither of which runs a script with such a name."""
LARGEST_INTEGER = 1e15
"""Largest whole number that a script for Matlab has without a decimal point, exact in a double-precision number."""
MOST_DENSE_ENTRIES = 400
"""Most entries of a matrix that a script writes in full, as larger ones are shorter by their nonzero entries."""


def to_matlab(drivetrain: Drivetrain) -> str:
    """Script text that runs in Matlab and Octave and defines the matrices of a drivetrain in SI.

    Variables are M, C, K, F, Y0, Y1, Y2, Yu, T with ``M q'' + C q' + K q = F u``, ``y = Y0 q + Y1 q' + Y2 q'' + Yu u``
    and ``theta = T q``; cell arrays of the names of coordinates, nodes, inputs and outputs; a structure
    ``state_space`` of A, B, C and D; and where the Control System Toolbox is there, ``sys`` with named signals.
    Numbers have all digits.

    Raises
    ------
    UsageError
        A stiffness that depends on frequency, an input that imposes an angle, or laws of motion without an operating
        point.

    Warns
    -----
    TorsionnetWarning
        A reading contains the rate of change of an input: the state space is left out.

    Examples
    --------
    >>> import torsionnet as tn
    >>> [line for line in to_matlab(tn.load("dmf_rig")).splitlines() if line.startswith("coordinates")]
    ["coordinates = {'motor', 'primary'};  % q"]
    """
    refuse_laws_of_motion(drivetrain, "a script of matrices for Matlab")
    system = matrices(drivetrain)
    states, reason = _states(drivetrain)
    lines = [*_head(drivetrain), f"title = {_quoted(drivetrain.title)};"]
    notes = ", ".join(map(_quoted, export_losses(drivetrain, "matlab").sentences()))
    lines.append(f"notes = {{{notes}}};  % what the model has and this file has not")
    for name, meaning in NAME_MEANINGS.items():
        listed = ", ".join(_quoted(text) for text in getattr(system, name))
        lines.append(f"{name} = {{{listed}}};{f'  % {meaning}' if meaning else ''}")
    lines += ["", "% M q'' + C q' + K q = F u,   y = Y0 q + Y1 q' + Y2 q'' + Yu u,   theta = T q"]
    for name, meaning in MATRIX_MEANINGS.items():
        lines += [f"% {name}: {meaning}", *_matrix(name, getattr(system, name))]
    if states is None:
        lines += ["", f"% no state space: {_one_line(reason)}"]
    else:
        lines += ["", "% x' = A x + B u,   y = C x + D u"]
        for name in "ABCD":
            lines += _matrix(f"state_space.{name}", getattr(states, name))
        lines += ["if exist('ss', 'file')", *_named_system(system), "end"]
    return "\n".join([*lines, ""])


def write_matlab(drivetrain: Drivetrain, path: str | os.PathLike[str]) -> None:
    """Write a drivetrain's matrices as a script (.m, see :func:`to_matlab`) or as a MAT v5 file (.mat).

    Raises
    ------
    UsageError
        Any other ending, a name Matlab cannot run a script under, or as :func:`to_matlab`.
    """
    target = Path(path)
    ending = target.suffix.lower()
    if ending == ".m":
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,62}", target.stem):
            raise UsageError(
                f'Matlab runs no script named "{target.name}"; use letters, digits and _, beginning with a letter',
                kind="invalid-name",
            )
        if target.stem in RESERVED_WORDS | MATRIX_MEANINGS.keys() | NAME_MEANINGS.keys() | {
            "title",
            "notes",
            "state_space",
            "sys",
        }:
            what = "a word of Matlab's own" if target.stem in RESERVED_WORDS else "a variable that the script sets"
            raise UsageError(
                f'Matlab cannot run "{target.name}": {target.stem} is {what}; e.g. {target.stem}_model.m',
                kind="invalid-name",
            )
        write_text(target, to_matlab(drivetrain))
    elif ending == ".mat":
        write_bytes(target, mat_bytes(_variables(drivetrain)))
    else:
        raise UsageError(f'cannot write "{path}": give a file ending in .m or .mat', kind="wrong-file")


def _variables(drivetrain: Drivetrain) -> dict[str, Any]:
    refuse_laws_of_motion(drivetrain, "a script of matrices for Matlab")
    system = matrices(drivetrain)
    states, _ = _states(drivetrain)
    content: dict[str, Any] = {"title": drivetrain.title}
    content |= {name: cell_array(getattr(system, name)) for name in NAME_MEANINGS}
    content["notes"] = cell_array(export_losses(drivetrain, "matlab").sentences())
    content |= {name: np.asarray(getattr(system, name), dtype=float) for name in MATRIX_MEANINGS}
    if states is not None:
        content["state_space"] = {name: getattr(states, name) for name in "ABCD"}
    return content


def _states(drivetrain: Drivetrain) -> tuple[StateSpace | None, str]:
    try:
        return state_space(drivetrain), ""
    except UsageError as error:
        warn_user(f"without state space: {error}")
        return None, str(error)


def _head(drivetrain: Drivetrain) -> list[str]:
    texts = [drivetrain.title, f"source: {drivetrain.source}" if drivetrain.source else "", drivetrain.description]
    values = [f"{name} = {value!r}" for name, value in drivetrain.parameters.items()]
    note = f"parameters (SI): {', '.join(values)}" if values else ""
    return [*(f"% {_one_line(text)}" for text in (*texts, note) if text), "% SI units, angles in rad", ""]


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _quoted(text: str) -> str:
    return "'" + _one_line(text).replace("'", "''") + "'"


def _matrix(name: str, values: Any) -> list[str]:
    rows, columns = values.shape
    if not values.size or not values.any():
        return [f"{name} = zeros({rows}, {columns});"]
    if values.size > MOST_DENSE_ENTRIES:
        i, j = np.nonzero(values)
        lists = [_row(i + 1), _row(j + 1), _row(values[i, j])]
        return [
            f"{name} = full(sparse([{lists[0]}], ...",
            f"    [{lists[1]}], ...",
            f"    [{lists[2]}], {rows}, {columns}));",
        ]
    texts = [_row(row) for row in values]
    return [f"{name} = [{texts[0]}", *(f"    {text}" for text in texts[1:-1]), f"    {texts[-1]}];"] if rows > 1 else [
        f"{name} = [{texts[0]}];"
    ]  # fmt: skip


def _row(values: Iterable[Any]) -> str:
    return " ".join(
        repr(int(value)) if value == int(value) and abs(value) < LARGEST_INTEGER else repr(float(value))
        for value in values
    )


def _named_system(system: Matrices) -> list[str]:
    names = ["'InputName', inputs" if system.inputs else "", "'OutputName', outputs" if system.outputs else ""]
    more = "".join(f", {name}" for name in names if name)
    return [f"    sys = ss(state_space.A, state_space.B, state_space.C, state_space.D{more});"]
