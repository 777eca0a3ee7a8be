"""What Python may give where a file has a number, a pair or a table: the names in signatures that type checkers see.

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
    """A quantity of pint."""

    @property
    def magnitude(self) -> Any:
        """The number."""

    @property
    def units(self) -> Any:
        """Its unit."""


class GivenTransferFunction(Protocol):
    """A transfer function of python-control or scipy."""

    @property
    def num(self) -> Any:
        """Coefficients above, the highest power of s first."""

    @property
    def den(self) -> Any:
        """Coefficients below."""


class GivenStateSpace(Protocol):
    """A system of python-control or scipy in state space."""

    @property
    def A(self) -> Any:
        """From states to their rates."""

    @property
    def B(self) -> Any:
        """From what is sensed."""

    @property
    def C(self) -> Any:
        """To what acts."""

    @property
    def D(self) -> Any:
        """From what is sensed to what acts."""


WholeNumber: TypeAlias = int | np.integer[Any]
Scalar: TypeAlias = float | str | Fraction | Expression | QuantityWithUnit | np.integer[Any] | np.floating[Any]
"""A number in SI, a text with a unit or an expression of parameters, a quantity of pint."""
Scalars: TypeAlias = tuple[Scalar, ...] | list[Scalar] | list[float] | list[int] | list[str] | list[float | str]
TwoNames: TypeAlias = tuple[str, str] | list[str]
Entries: TypeAlias = Mapping[str, Any]
"""What a model file has between braces."""
NumberRows: TypeAlias = Sequence[Scalars] | np.ndarray[Any, Any] | Rows
NumberByNumber: TypeAlias = Mapping[str, Scalar] | Mapping[float, Scalar] | Mapping[float | str, Scalar] | Rows
