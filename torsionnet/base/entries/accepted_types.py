"""Types in signatures of calls from Python, which accept objects where a file has a number, a pair or a table.

Nothing imports this while the program runs. Where a list is accepted, no ``Sequence`` is said: a text is one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol, TypeAlias

import numpy as np

from torsionnet.base.expressions import Expression, Rows


class QuantityWithUnit(Protocol):
    """Interface of a quantity of pint, a number with its unit."""

    @property
    def magnitude(self) -> Any:
        """Number of the pint quantity without its unit."""

    @property
    def units(self) -> Any:
        """Unit of the pint quantity."""


class GivenTransferFunction(Protocol):
    """Interface of a transfer function of python-control or scipy."""

    @property
    def num(self) -> Any:
        """Coefficients of the transfer function's numerator, the highest power of s first."""

    @property
    def den(self) -> Any:
        """Coefficients of the transfer function's denominator, the highest power of s first."""


class GivenStateSpace(Protocol):
    """Interface of a state-space system of python-control or scipy."""

    @property
    def A(self) -> Any:
        """State matrix of the system, shape (n_states, n_states)."""

    @property
    def B(self) -> Any:
        """Input matrix of the system, from the sensed quantity to the states, shape (n_states, 1)."""

    @property
    def C(self) -> Any:
        """Output matrix of the system, from the states to the torque that acts, shape (1, n_states)."""

    @property
    def D(self) -> Any:
        """Feedthrough matrix of the system, from the sensed quantity to the torque, shape (1, 1)."""


WholeNumber: TypeAlias = int | np.integer[Any]
Scalar: TypeAlias = float | str | Fraction | Expression | QuantityWithUnit | np.integer[Any] | np.floating[Any]
"""Type of an argument that is a number in SI units, text with a unit, expression of parameters, or quantity of pint."""
Scalars: TypeAlias = tuple[Scalar, ...] | list[Scalar] | list[float] | list[int] | list[str] | list[float | str]
TwoNames: TypeAlias = tuple[str, str] | list[str]
Entries: TypeAlias = Mapping[str, Any]
"""Type of a mapping of entries, as a model file has between braces."""
NumberRows: TypeAlias = Sequence[Scalars] | np.ndarray[Any, Any] | Rows
NumberByNumber: TypeAlias = Mapping[str, Scalar] | Mapping[float, Scalar] | Mapping[float | str, Scalar] | Rows
