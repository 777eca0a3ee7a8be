"""Settings of a fit of modes to frequency responses (method, order, band, residual terms, weights, criteria)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

from torsionnet.base.errors import UsageError, did_you_mean

Method: TypeAlias = Literal["auto", "rational", "lscf"]
Residuals: TypeAlias = Literal["both", "lower", "upper", "none"]
Weights: TypeAlias = Literal["uniform", "relative", "coherence"]

DEFAULT_HIGHEST_ORDER = {"auto": 40, "rational": 10, "lscf": 40}
"""Highest order of the polynomials for each method, of which an oscillatory mode takes two."""


@dataclass(frozen=True)
class Criteria:
    """Criteria by which a pole at one order of a stabilisation diagram counts as the same at the next.

    Attributes
    ----------
    frequency, damping : float
        Largest relative change of ``|lambda|`` and of the damping ratio.
    shape : float
        Least MAC of the shapes.
    least_orders : int
        Orders in a row that make a cluster; by default a tenth of the orders of the diagram, at least 4.
    """

    frequency: float = 0.01
    damping: float = 0.05
    shape: float = 0.98
    least_orders: int | None = None

    def __post_init__(self) -> None:
        for name in ("frequency", "damping", "shape"):
            value = getattr(self, name)
            if not (math.isfinite(value) and 0 < value <= 1):
                raise UsageError(f"the criterion for {name} must be a fraction above 0 and up to 1, got {value}")
        if self.least_orders is not None and self.least_orders < 2:
            raise UsageError(f"a cluster needs the poles of at least 2 orders, got least_orders={self.least_orders}")

    def enough(self, orders: int) -> int:
        """Number of orders in a row over which a pole must stay to be a mode, in a diagram of ``orders`` orders."""
        return max(4, orders // 10) if self.least_orders is None else self.least_orders


@dataclass(frozen=True)
class Settings:
    """Method and options of a fit of modes to frequency responses (order, band, residual terms, weights).

    Attributes
    ----------
    method : {"auto", "rational", "lscf"}
        ``"auto"``: the method with the lower Schwarz criterion (BIC); the rational fraction unless that is clear.
        ``"rational"``: a quotient of polynomials in s = j omega, orthogonal over the lines, solved repeatedly with the
        last denominator as weight; for few modes of any damping, overdamped ones too. ``"lscf"``: least
        squares of complex frequency, polynomials in z = exp(j omega / (2 f_max)); for many modes of light damping.
    highest_order : int, optional
        Order of the polynomials; an oscillatory mode takes two orders, a real pole one. By default 10 or 40, which
        ``auto`` takes for each.
    band : (float, float), optional
        Hz; by default all frequencies above 0 up to where a test says that it can be used.
    residuals : {"both", "lower", "upper", "none"}
        Real terms of the receptance for what is below the band, ``L / s^2``, and above it, ``U``.
    weights : {"uniform", "relative", "coherence"}
        ``"uniform"``: a transfer function is equally uncertain over the band; ``"relative"``: in proportion to its
        size; ``"coherence"``: as its coherence says.
    criteria : Criteria

    Examples
    --------
    >>> Settings("lscf").order
    40
    """

    method: Method = "auto"
    highest_order: int | None = None
    band: tuple[float, float] | None = None
    residuals: Residuals = "both"
    weights: Weights = "uniform"
    criteria: Criteria = field(default_factory=Criteria)

    def __post_init__(self) -> None:
        for name, known in (("method", Method), ("residuals", Residuals), ("weights", Weights)):
            chosen = getattr(self, name)
            if chosen not in get_args(known):
                choices = ", ".join(get_args(known))
                raise UsageError(
                    f'{name} "{chosen}" is not known{did_you_mean(str(chosen), get_args(known))}; choose {choices}'
                )
        if self.order < 1:
            raise UsageError(f"the highest order must be at least 1, got {self.highest_order}")
        if self.band is not None and not 0 <= self.band[0] < self.band[1]:
            raise UsageError(f"the band must be from a lower to a higher frequency in Hz, got {self.band}")

    @property
    def order(self) -> int:
        """Highest order of the polynomials in a fit of modes, as set or the default of the method."""
        return DEFAULT_HIGHEST_ORDER[self.method] if self.highest_order is None else self.highest_order

    @property
    def has_lower(self) -> bool:
        """Whether the fit has a residual term that stands for modes below the band."""
        return self.residuals in ("both", "lower")

    @property
    def has_upper(self) -> bool:
        """Whether the fit has a residual term that stands for modes above the band."""
        return self.residuals in ("both", "upper")
