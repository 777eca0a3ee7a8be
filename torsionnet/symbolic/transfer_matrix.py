"""Matrix of symbolic transfer functions over several outputs and inputs, from one program.

For measured inputs m under as many excitations the matrix is Y_out Y_in^-1. The determinant of the drivetrain drops
out, and so does the strength of every excitation: an imposed angle is as good as the torque that makes it. By Cramer's
rule the entry for output o and input i is the determinant of Y_in with its row i exchanged for that of the output, over
the determinant of Y_in.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import TypeAlias

import numpy as np
import sympy
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.program import Program, ProgramNode
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.model.channels import Input, Sensor
from torsionnet.symbolic.algebra.algebras import vanishes
from torsionnet.symbolic.mechanism import Mechanism, loose_constraints, parts_of
from torsionnet.symbolic.symbolic_request import hold_imposed_angles, is_imposed, mechanism
from torsionnet.symbolic.transfer_function import TransferFunction

Write: TypeAlias = Callable[[tuple[Channel, Channel], ProgramNode, ProgramNode, tuple[str, ...]], TransferFunction]

MOST_MEASURED = 3
"""Largest number of measured inputs of a symbolic matrix, as the terms of their determinants multiply."""


@dataclass(frozen=True, eq=False)
class TransferMatrix:
    """Matrix of symbolic transfer functions, a row for each output and a column for each input.

    Attributes
    ----------
    entries : tuple of tuple of TransferFunction
        A row for every output.

    Examples
    --------
    >>> import torsionnet as tn
    >>> G = tn.load("dmf_rig").symbolic().transfer_matrix(["theta_1", "primary"], ["motor", "primary"])
    >>> G.shape
    (2, 2)
    >>> G["primary", "primary"].static_gain
    1/k_2
    """

    entries: tuple[tuple[TransferFunction, ...], ...]

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.entries), len(self.entries[0])

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(row[0].channels[0].name for row in self.entries)

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(entry.channels[1].name for entry in self.entries[0])

    def __getitem__(self, place: tuple[int | str, int | str]) -> TransferFunction:
        """Transfer function of one output (row) and one input (column), given by numbers or names."""
        row, column = (_place(key, names) for key, names in zip(place, (self.outputs, self.inputs), strict=True))
        return self.entries[row][column]

    def evaluate(self, frequencies: ArrayLike, **parameters: float) -> FrequencyResponse:
        """Frequency response of all entries at frequencies in Hz, values (n_f, n_out, n_in) in SI units."""
        responses = [[entry.evaluate(frequencies, **parameters) for entry in row] for row in self.entries]
        first = responses[0][0]
        return replace(
            first,
            values=np.stack([np.stack([entry.values[:, 0, 0] for entry in row], axis=1) for row in responses], axis=1),
            outputs=tuple(row[0].outputs[0] for row in responses),
            inputs=tuple(entry.inputs[0] for entry in responses[0]),
        )

    def to_latex(self, form: str = "mechanical") -> str:
        """LaTeX of the matrix, with all transfer functions in one form."""
        rows = (" & ".join(entry.to_latex(form) for entry in row) for row in self.entries)
        return "\\begin{bmatrix}\n" + " \\\\\n".join(rows) + "\n\\end{bmatrix}"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.to_latex()}$"

    def __str__(self) -> str:
        return "\n".join(str(entry) for row in self.entries for entry in row)

    def __repr__(self) -> str:
        return f"<TransferMatrix {', '.join(self.outputs)} / {', '.join(self.inputs)}>"


def _place(key: int | str, names: Sequence[str]) -> int:
    if isinstance(key, int):
        return key
    if key not in names:
        raise UsageError(
            f'no row or column is named "{key}"{did_you_mean(key, names)}; choose {", ".join(names)}',
            kind="unknown-name",
        )
    return names.index(key)


def measured_transfer_matrix(drivetrain: AssembledModel, request: TransferRequest, write: Write) -> TransferMatrix:
    """Matrix of transfer functions against several measured inputs under as many excitations.

    ``write`` makes a transfer function of channels, numerator and denominator.

    Raises
    ------
    UsageError
        There are more than three measured inputs, or they depend on each other.
    """
    if len(request.inputs) > MOST_MEASURED:
        raise UsageError(f"in symbols at most {MOST_MEASURED} inputs are measured at a time", kind="too-large")
    sensors = request.sensors
    program, mechanisms = Program(), dict[Input | None, Mechanism]()
    columns = []
    for source in request.excitations:
        driven = source if source.quantity == "angle" else None
        seen = mechanisms.get(driven) or _mechanism(drivetrain, driven, sensors, program)
        mechanisms[driven] = seen
        columns.append([seen.numerator(parts_of(seen, sensor), source.row) for sensor in sensors])
    return _by_cramer(program, [list(row) for row in zip(*columns, strict=True)], request, write)


def _mechanism(
    drivetrain: AssembledModel, driven: Input | None, sensors: Sequence[Sensor], program: Program
) -> Mechanism:
    """Symbolic drivetrain with all imposed angles at rest except that of the input ``driven``."""
    system = hold_imposed_angles(drivetrain, driven) if is_imposed(drivetrain) else drivetrain
    return mechanism(system, loose=loose_constraints(system, sensors), program=program)


def _by_cramer(
    program: Program, readings: list[list[ProgramNode]], request: TransferRequest, write: Write
) -> TransferMatrix:
    above, below = readings[: len(request.outputs)], readings[len(request.outputs) :]
    # Y_out Y_in^-1 by Cramer's rule: Y_in with its row i replaced by a row of Y_out, over det Y_in.
    whole = _determinant(program, below)
    if vanishes(whole):
        raise UsageError(
            "the measured inputs depend on each other under these excitations: there are no transfer functions; "
            "measure elsewhere",
            kind="dependent-inputs",
        )
    return TransferMatrix(
        tuple(
            tuple(
                write(
                    (output.channel, measured.channel),
                    *program.reduced(_determinant(program, [*below[:i], row, *below[i + 1 :]]), whole),
                    request.notes,
                )
                for i, measured in enumerate(request.inputs)
            )
            for output, row in zip(request.outputs, above, strict=True)
        )
    )


def _determinant(program: Program, rows: list[list[ProgramNode]]) -> ProgramNode:
    """Determinant of a small matrix of program nodes by Leibniz's sum, as a node of the program."""
    total = program.leaf(0)
    for order in permutations(range(len(rows))):
        term = program.leaf(sympy.LeviCivita(*order))
        for row, column in zip(rows, order, strict=True):
            term = term * row[column]
        total = total + term
    return total
