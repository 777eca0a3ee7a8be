"""Types for signatures: Python objects accepted where a file has a number, a pair or a table.

Nothing imports this while the program runs. Where a list is accepted, no ``Sequence`` is said: a text is one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol, TypeAlias

import numpy as np

from torsionnet.core.expressions import Expression
from torsionnet.core.piecewise_linear import Rows


class QuantityWithUnit(Protocol):
    """Quantity of pint."""

    @property
    def magnitude(self) -> Any:
        """Number without its unit."""

    @property
    def units(self) -> Any:
        """Unit of the quantity."""


class GivenTransferFunction(Protocol):
    """Transfer function of python-control or scipy."""

    @property
    def num(self) -> Any:
        """Coefficients of the numerator, the highest power of s first."""

    @property
    def den(self) -> Any:
        """Coefficients of the denominator, the highest power of s first."""


class GivenStateSpace(Protocol):
    """State-space system of python-control or scipy."""

    @property
    def A(self) -> Any:
        """State matrix of the system."""

    @property
    def B(self) -> Any:
        """Input matrix, from the sensed quantity."""

    @property
    def C(self) -> Any:
        """Output matrix, to the torque that acts."""

    @property
    def D(self) -> Any:
        """Feedthrough matrix, from the sensed quantity to the torque."""


WholeNumber: TypeAlias = int | np.integer[Any]
Scalar: TypeAlias = float | str | Fraction | Expression | QuantityWithUnit | np.integer[Any] | np.floating[Any]
"""Number in SI units, text with a unit, expression of parameters, or quantity of pint."""
Scalars: TypeAlias = tuple[Scalar, ...] | list[Scalar] | list[float] | list[int] | list[str] | list[float | str]
TwoNames: TypeAlias = tuple[str, str] | list[str]
Entries: TypeAlias = Mapping[str, Any]
"""Mapping of entries as a model file has between braces."""
NumberRows: TypeAlias = Sequence[Scalars] | np.ndarray[Any, Any] | Rows
NumberByNumber: TypeAlias = Mapping[str, Scalar] | Mapping[float, Scalar] | Mapping[float | str, Scalar] | Rows
