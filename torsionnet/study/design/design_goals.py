"""Goals of a design, which are targets, objectives and limits of quantities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityLimit

Found = Mapping[str, FloatArray]
"""Mapping of each quantity to its values (n, n_points) in SI for n designs."""


def with_unit(value: float, unit: str) -> str:
    """Text of a number with its unit, to six digits.

    >>> with_unit(0.00855201, "rad"), with_unit(0.25, "")
    ('0.00855201 rad', '0.25')
    """
    return f"{value:.6g} {unit}".rstrip()


@dataclass(frozen=True)
class DesignTarget:
    """Target value in SI of a quantity, with ``weight``, for deviations relative to the value, unless it is 0."""

    quantity: str
    value: float
    weight: float = 1.0

    @property
    def scale(self) -> float:
        return self.weight / (abs(self.value) or 1.0)


@dataclass(frozen=True)
class DesignObjective:
    """Objective of a design, the worst of these quantities at the worst of their points, minimised or maximised."""

    quantities: tuple[str, ...]
    sense: str = "minimise"

    @property
    def sign(self) -> float:
        return -1.0 if self.sense == "maximise" else 1.0

    @property
    def name(self) -> str:
        return self.quantities[0] if len(self.quantities) == 1 else f"worst of {', '.join(self.quantities)}"

    def columns(self, found: Found) -> FloatArray:
        """Values (n, n_columns) of n designs that are to be small, the quantities' times the sign of the objective."""
        return self.sign * np.concatenate([found[name] for name in self.quantities], axis=1)

    def shown(self, size: float) -> float:
        """Value in SI of the objective's quantity from a value of :meth:`columns`, which has the objective's sign."""
        return self.sign * size


@dataclass(frozen=True, eq=False)
class DesignGoals:
    """Targets or objectives of a design, and the limits of its quantities.

    Attributes
    ----------
    targets : tuple of DesignTarget
    objectives : tuple of DesignObjective
    limits : mapping
        Quantity -> limit, SI.
    units : mapping
        Quantity -> unit in SI, for words and tables; others are shown without a unit.

    Examples
    --------
    >>> goals = DesignGoals(targets=(DesignTarget("f", 8.0),), limits={"x": QuantityLimit(below=2.0)})
    >>> found = {"f": np.array([[8.0], [10.0]]), "x": np.array([[1.0], [3.0]])}
    >>> goals.deviations(found).ravel().tolist(), goals.excess(found).ravel().tolist()
    ([0.0, 0.25], [-0.5, 0.5])
    """

    targets: tuple[DesignTarget, ...] = ()
    objectives: tuple[DesignObjective, ...] = ()
    limits: Mapping[str, QuantityLimit] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.targets and not self.objectives and not self.limits:
            raise UsageError("say what is sought: targets, or what to minimise or maximise")
        if self.targets and self.objectives:
            raise UsageError("either targets or something to minimise or maximise; make the targets limits, or these")
        for one in self.targets:
            if not (np.isfinite(one.value) and one.weight > 0):
                raise UsageError(f"the target of {one.quantity} is a number with a weight above 0")

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the quantities of all targets, objectives and limits, each once."""
        named = [one.quantity for one in self.targets]
        named += [name for one in self.objectives for name in one.quantities]
        return tuple(dict.fromkeys([*named, *self.limits]))

    def unit_of(self, objective: DesignObjective) -> str:
        """SI unit of an objective; empty where its quantities have different ones."""
        units = {self.units.get(name, "") for name in objective.quantities}
        return units.pop() if len(units) == 1 else ""

    def require_merit(self) -> None:
        """Refuse goals that are limits alone, of which no design is the best."""
        if not self.targets and not self.objectives:
            raise UsageError("limits alone choose no design; say what to minimise or maximise, or targets")

    def check(self, known: Mapping[str, object]) -> None:
        """Refuse goals of a design with quantities that are not among those known."""
        for name in self.quantities:
            if name not in known:
                there = ", ".join(known)
                raise UsageError(f'no quantity is named "{name}"{did_you_mean(name, known)}; there are {there}')

    def deviations(self, found: Found) -> FloatArray:
        """Relative, weighted deviations from targets (n, n_targets) of n designs, those of a curve at every point."""
        parts = [one.scale * (found[one.quantity] - one.value) for one in self.targets]
        return np.concatenate(parts, axis=1)

    def excess(self, found: Found) -> FloatArray:
        """Excess (n, n_points of limited quantities) over limits, relative to them; below 0 where they are kept."""
        parts = [sign * (found[name] - bound) / (abs(bound) or 1.0) for name, sign, bound in self.bounds()]
        count = len(next(iter(found.values())))
        return np.concatenate(parts, axis=1) if parts else np.zeros((count, 0))

    def excess_slopes(self, moved: Found) -> FloatArray:
        """Derivatives (n_excess, n_p) of :meth:`excess` from those (n_points, n_p) of the quantities."""
        parts = [sign * moved[name] / (abs(bound) or 1.0) for name, sign, bound in self.bounds()]
        width = next(iter(moved.values())).shape[1]
        return np.concatenate(parts) if parts else np.zeros((0, width))

    def bounds(self) -> Iterator[tuple[str, float, float]]:
        """Yield the quantity, sign (1 of an upper, -1 of a lower limit) and value in SI of every limit."""
        for name, limit in self.limits.items():
            if limit.below is not None:
                yield name, 1.0, limit.below
            if limit.above is not None:
                yield name, -1.0, limit.above

    def merit(self, found: Found) -> FloatArray:
        """Merit (n,) of n designs, to be minimised, the sum of squared deviations, or the worst of the objective."""
        if self.targets:
            size = np.sum(self.deviations(found) ** 2, axis=1)
        else:
            size = self.objectives[0].columns(found).max(axis=1)
        # A design without one of the quantities is worse than any other.
        return np.where(np.isnan(size), np.inf, size)

    def violation(self, found: Found) -> FloatArray:
        """Sum (n,) of the relative excess over limits of n designs.

        Infinite where a quantity could not be calculated.
        """
        over = np.maximum(self.excess(found), 0.0).sum(axis=1)
        return np.where(np.isnan(over), np.inf, over)
