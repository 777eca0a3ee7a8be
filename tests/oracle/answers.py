"""Exact transfer functions of a question: at frequencies above zero, and the limit at zero."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from flint import acb, acb_mat, arb

from oracle.description import Reading
from oracle.elimination import SingularError
from oracle.exact import imaginary, precision
from oracle.solution import GENERIC_S, Mechanics, s_of

BITS, MOST_BITS, ENOUGH = 512, 8192, 80
"""Precision to begin with, and where a value that still contains zero is zero; bits that a value must have."""
SMALL = 400
"""Zero frequency is taken at s = j 2^-SMALL and, to see how a value grows, at 2^-100 of that."""
FURTHER = 100

Table: TypeAlias = list[list[acb]]
INFINITE = "infinite"


class SingularInputError(ArithmeticError):
    """The measured inputs vanish, or do not tell the excitations apart, at every frequency."""


@dataclass(frozen=True)
class Question:
    """Outputs under excitations (quantity, node), or against as many measured readings under them."""

    outputs: tuple[Reading, ...]
    excitations: tuple[tuple[str, str], ...]
    measured: tuple[Reading, ...] = ()


@dataclass
class Answer:
    """Exact values of one question."""

    mechanics: Mechanics
    question: Question

    def _at(self, s: Callable[[], acb]) -> Table:
        """Outputs over inputs at s, at the current precision; s is made anew for each."""
        q = self.question
        readings = self.mechanics.at(s(), q.excitations, (*q.outputs, *q.measured))
        outputs, measured = readings[: len(q.outputs)], readings[len(q.outputs) :]
        if not q.measured:
            return outputs
        if len(q.measured) == 1:
            return [[value / measured[0][0]] for (value,) in outputs]
        inverse = acb_mat(measured).inv()
        return (acb_mat(outputs) * inverse).tolist()

    def sizes(self, frequency: float) -> Table:
        """What rounding of a value has to be compared with: its terms, each as large as its kind gets in this model."""
        q = self.question
        with precision(4 * BITS):
            s = s_of(frequency)
            own = self.mechanics.sizes(s, q.excitations, (*q.outputs, *q.measured))[: len(q.outputs)]
            if not q.measured:
                return own
            measured = self.mechanics.at(s, q.excitations, q.measured)
            inverse = [[acb(abs(value)) for value in row] for row in acb_mat(measured).inv().tolist()]
            return (acb_mat(own) * acb_mat(inverse)).tolist()

    @cached_property
    def zeros(self) -> list[list[bool]]:
        """Which transfer functions are zero at every s; raises where the measured input is."""
        bits = BITS
        while True:
            with precision(bits):
                s = lambda: acb(arb(GENERIC_S[0]), arb(GENERIC_S[1]))  # noqa: E731
                try:
                    table = self._at(s)
                    unsure = [[not _is_accurate(value) for value in row] for row in table]
                except (SingularError, ZeroDivisionError):
                    table = None
                if table is not None and not any(any(row) for row in unsure):
                    return unsure
            if bits >= MOST_BITS:
                if table is None or any(not value.is_finite() for row in table for value in row):
                    raise SingularInputError
                return [[value.contains(0) for value in row] for row in table]
            bits *= 4

    def at(self, frequency: float) -> Table:
        """Values at a frequency in Hz; those that vanish identically are exact zeros."""
        return self._accurate(lambda: s_of(frequency), BITS)

    def _accurate(self, s: Callable[[], acb], bits: int) -> Table:
        zeros = self.zeros
        while True:
            with precision(bits):
                try:
                    table = self._at(s)
                except (SingularError, ZeroDivisionError):
                    table = None
                if table is not None and all(
                    zero or _is_accurate(value)
                    for row, flags in zip(table, zeros, strict=True)
                    for value, zero in zip(row, flags, strict=True)
                ):
                    return [
                        [acb(0) if zero else value for value, zero in zip(row, flags, strict=True)]
                        for row, flags in zip(table, zeros, strict=True)
                    ]
            bits *= 2
            if bits > 4 * MOST_BITS:
                raise SingularError

    def at_rest(self) -> list[list[acb | str]]:
        """Limits for zero frequency, INFINITE where a value grows without bound."""
        near = self._accurate(lambda: imaginary(arb(2) ** -SMALL), MOST_BITS // 2)
        nearer = self._accurate(lambda: imaginary(arb(2) ** -(SMALL + FURTHER)), MOST_BITS // 2)
        return [[_limit(a, b) for a, b in zip(*rows, strict=True)] for rows in zip(near, nearer, strict=True)]


def _limit(near: acb, nearer: acb) -> acb | str:
    if near == 0 or nearer == 0:
        return acb(0)
    power = round(float(abs(near / nearer).log() / arb(2).log()) / FURTHER)
    if power == 0:
        return nearer
    return INFINITE if power < 0 else acb(0)


def _is_accurate(value: acb) -> bool:
    return value.is_finite() and not value.contains(0) and value.rel_accuracy_bits() >= ENOUGH
