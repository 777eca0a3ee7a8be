"""State equations x' = A x + B u split into uncoupled triangular blocks, which are easy to step exactly.

The states of rigid rotation, whose poles at zero are multiple and have no eigenvectors of their own, are a block by
themselves. The rest is diagonal where its eigenvectors are well conditioned, with one of each conjugate pair only, and
one triangular block where they are not (critical damping).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray

REST_POLE_RATIO = 1e-7
"""Size of a pole, over the largest pole, below which it is grouped with the poles at zero, as rounding moves those of
rigid rotation that far."""
MOST_EIGENVECTOR_CONDITION = 1e7
"""Condition number of the eigenvectors up to which a block is made diagonal, as too many digits are lost beyond it."""


@dataclass(frozen=True)
class DiagonalBlock:
    """Uncoupled block z' = T z + B u with T upper triangular, which adds Re(C z) to the outputs."""

    T: ComplexArray
    B: ComplexArray
    C: ComplexArray

    @property
    def is_diagonal(self) -> bool:
        return not np.triu(self.T, 1).any()


def blocks(A: FloatArray, B: FloatArray, C: FloatArray) -> list[DiagonalBlock]:
    """Uncoupled blocks whose outputs add up to those of x' = A x + B u, y = C x.

    The shapes are A (n, n), B (n, n_in) and C (n_out, n).
    """
    if not len(A):
        return []
    balanced, (scale, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    size = np.abs(scipy.linalg.eigvals(balanced)).max()
    schur: Any = scipy.linalg.schur
    T, Q, resting = schur(balanced, output="complex", sort=lambda pole: abs(pole) <= REST_POLE_RATIO * size)
    inputs, outputs = Q.conj().T @ (B / scale[:, None]), (C * scale) @ Q
    rest = slice(0, resting), slice(resting, None)
    if 0 < resting < len(A):
        # [I X; 0 I] with T_00 X - X T_11 = -T_01 takes the coupling of poles at rest and the others away.
        across = scipy.linalg.solve_sylvester(T[rest[0], rest[0]], -T[rest[1], rest[1]], -T[rest[0], rest[1]])
        inputs[rest[0]] -= across @ inputs[rest[1]]
        outputs[:, rest[1]] += outputs[:, rest[0]] @ across
    parts = [DiagonalBlock(T[part, part], inputs[part], outputs[:, part]) for part in rest if len(T[part])]
    return [_diagonal(part) if number == len(parts) - 1 else part for number, part in enumerate(parts)]


def _diagonal(block: DiagonalBlock) -> DiagonalBlock:
    """Block made diagonal by its eigenvectors where these are well conditioned, else the block unchanged."""
    poles, vectors = np.linalg.eig(block.T)
    if np.linalg.cond(vectors) > MOST_EIGENVECTOR_CONDITION:
        return block
    inputs: ComplexArray = np.asarray(np.linalg.solve(vectors, block.B), dtype=np.complex128)
    outputs = block.C @ vectors
    upper = poles.imag > REST_POLE_RATIO * np.abs(poles)
    real = np.abs(poles.imag) <= REST_POLE_RATIO * np.abs(poles)
    if 2 * upper.sum() + real.sum() != len(poles):
        return DiagonalBlock(np.diag(poles).astype(complex), inputs, outputs)
    kept = upper | real
    weight = np.where(upper, 2.0, 1.0)[kept]
    return DiagonalBlock(np.diag(poles[kept]).astype(complex), inputs[kept], outputs[:, kept] * weight)
