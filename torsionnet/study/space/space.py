"""Space of the variants of a study: its variations in SI relative to a model, and the values of each variant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, prod
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np

from torsionnet.base.entries.composite import Listed, Named, Nested, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import Json, entry
from torsionnet.base.errors import EntryPath, Fault, ModelError, unknown_name
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.model.changes import value_of_entry
from torsionnet.model.elements import Element
from torsionnet.model.model import Model
from torsionnet.study.space.correlation import Correlation, name_faults, normal_correlation
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.variations.variation import (
    VARIATIONS,
    GridAxis,
    Marginal,
    NominalReader,
    Variation,
    nominals,
    parameter_uses,
)

# Variations of a study in SI, relative to the values of a model, and the faults of their entries.

# Joint distribution of several parameters, joined by a Gaussian copula.


@dataclass(frozen=True, eq=False)
class JointDistribution:
    """Distributions of parameters, joined as functions of correlated normal variables (Gaussian copula).

    Attributes
    ----------
    marginals : mapping
        Parameter -> its distribution.
    root : (n, n) array or None
        Lower triangular factor from independent to correlated normal variables; None where nothing is correlated.
    """

    marginals: Mapping[str, Marginal]
    root: FloatArray | None

    def from_unit(self, shares: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each parameter, by its name, at points (n, n_names) of the unit cube.

        Where there is correlation, the values of a parameter depend on the shares of those before it, too.
        """
        if self.root is not None:
            from torsionnet.study.space.variations.normal import normal_quantile

            return self.from_standard_normal(normal_quantile(shares))
        return {name: marginal.ppf(shares[:, place]) for place, (name, marginal) in enumerate(self.marginals.items())}

    def from_standard_normal(self, normal: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each parameter, by its name, at independent standard normal variables (n, n_names)."""
        marginals = enumerate(self.marginals.items())
        return {name: marginal.from_normal(self._correlated(normal, place)) for place, (name, marginal) in marginals}

    def _correlated(self, normal: FloatArray, place: int) -> FloatArray:
        """Values (n,) of one correlated normal variable from independent ones (n, n_names).

        Summed term by term: a product of matrices rounds differently with the number of rows.
        """
        if self.root is None:
            return normal[:, place]
        row = self.root[place]
        return np.asarray(sum(row[term] * normal[:, term] for term in np.flatnonzero(row).tolist()))

    def to_standard_normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Independent standard normal variables (n, n_names) of parameter values (n,) in SI by name."""
        return self._independent(self._normal(values))

    def _normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        return np.stack([marginal.to_normal(values[name]) for name, marginal in self.marginals.items()], axis=-1)

    def _independent(self, correlated: FloatArray) -> FloatArray:
        return correlated if self.root is None else np.asarray(np.linalg.solve(self.root, correlated.T).T)

    def log_density(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Logarithm (n,) of the joint probability density at parameter values (n,) in SI by name."""
        density = np.sum([marginal.log_density(values[name]) for name, marginal in self.marginals.items()], axis=0)
        if self.root is None:
            return np.asarray(density)
        correlated = np.where(np.isfinite(density)[:, None], self._normal(values), 0.0)
        # Gaussian copula: ln c = (|z|^2 - |u|^2)/2 - ln det L, with z = L u.
        squares = (correlated**2).sum(axis=1) - (self._independent(correlated) ** 2).sum(axis=1)
        return np.asarray(density + squares / 2 - np.log(np.diag(self.root)).sum())


NEGLIGIBLE_SHARE = 1e-9
"""Share of the variants that may be impossible without a fault, as a larger one would hide rare failures."""


def unreachable(model: Model, marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]) -> list[Fault]:
    """Errors of variations with values that the model refuses, and warnings of values outside a parameter's bounds.

    Only parameters that are themselves a value of an element are looked at; what is calculated from several is seen
    where the variants are made.
    """
    uses = parameter_uses(model)
    faults: list[Fault] = []
    for name in (*marginals, *axes):
        own = [fault for use in uses.get(name, ()) for fault in _impossible(name, use.quantity, marginals, axes)]
        bounds = model.parameter_definitions[name].bounds
        if bounds and not own:
            own = [replace(fault, severity="warning") for fault in _outside(name, bounds, marginals, axes)]
        faults += [fault.under("vary", name) for fault in own]
    return faults


def _impossible(
    name: str, spec: QuantityKind[object], marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]
) -> Iterator[Fault]:
    if name in axes:
        ends = (axes[name].low, axes[name].high)
        reasons = {value: reason for value in ends if (reason := spec.bound_fault(value))}
        for value, reason in reasons.items():
            yield Fault(f"{name} would be {value:g}: {spec.description} {reason}", kind="out-of-range")
        passes = spec.nonzero and not reasons and ends[0] < 0 < ends[1]
    else:
        if spec.lower is not None:
            reason = spec.bound_fault(spec.lower - 1)
            yield from _tails(name, marginals[name], spec.lower, inf, f"{spec.description} {reason}")
        sides = float(marginals[name].cdf(0.0)), float(marginals[name].sf(0.0))
        passes = spec.nonzero and min(sides) > NEGLIGIBLE_SHARE
    if passes:
        yield Fault(
            f"{name} would pass through 0: {spec.description} must not be zero; keep it on one side",
            kind="out-of-range",
        )


def _outside(
    name: str, bounds: tuple[float, float], marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]
) -> Iterator[Fault]:
    text = f"its bounds in the model are {bounds[0]:g} to {bounds[1]:g}"
    if name in marginals:
        yield from _tails(name, marginals[name], *bounds, text)
        return
    ends = dict.fromkeys(value for value in (axes[name].low, axes[name].high) if not bounds[0] <= value <= bounds[1])
    if ends:
        yield Fault(f"{name} would be {' and '.join(f'{value:g}' for value in ends)}; {text}", kind="out-of-range")


def _tails(name: str, marginal: Marginal, lower: float, upper: float, what: str) -> Iterator[Fault]:
    """Yield the faults of a distribution with values below or above what is possible."""
    tails = (marginal.cdf(lower), "below", lower, "low"), (marginal.sf(upper), "above", upper, "high")
    for share, side, limit, key in tails:
        if share > NEGLIGIBLE_SHARE:
            text = f"{100 * float(share):.2g} % of {name} would be {side} {limit:g} ({what})"
            yield Fault(f"{text}; give {key}: {limit:g} to truncate", kind="out-of-range")


@dataclass(frozen=True, eq=False)
class BoundSpace:
    """Distributions and axes of the varied parameters in SI.

    Attributes
    ----------
    nominal : mapping
        Values in the model; NaN where it has none.
    joint : JointDistribution
        Joint distribution of the parameters that have one.
    axes : mapping
        Parameter -> axis, of the parameters with a list or range.
    """

    nominal: Mapping[str, float]
    joint: JointDistribution
    axes: Mapping[str, GridAxis]


def bound_space(
    vary: Mapping[str, Variation], correlation: Sequence[Correlation], sampling: Samples | None, model: Model
) -> tuple[BoundSpace | None, list[Fault]]:
    """Distributions and axes of the varied parameters in SI, None if there is an error, and all faults found."""
    faults = [_unknown(name, model) for name in vary if name not in model.parameters]
    known = nominals(model, [name for name in vary if name in model.parameters])
    marginals: dict[str, Marginal] = {}
    axes: dict[str, GridAxis] = {}
    for name, nominal in known.items():
        reader = NominalReader(nominal)
        bound = vary[name].bound(reader)
        faults += [fault.under("vary", name) for fault in reader.faults]
        if isinstance(bound, Marginal):
            marginals[name] = bound
        elif bound is not None:
            axes[name] = bound
    faults += unreachable(model, marginals, axes)
    faults += [fault.under("sampling") for fault in _sampling_faults(vary, sampling)]
    # Draws are coloured by the Cholesky factor of the correlation of the normal variables.
    root, wrong = _root(vary, correlation, marginals)
    faults += [fault.under("correlation") for fault in wrong]
    if any(fault.severity == "error" for fault in faults):
        return None, faults
    values = {name: np.nan if given.value is None else given.value for name, given in known.items()}
    return BoundSpace(values, JointDistribution(marginals, root), axes), faults


def _unknown(name: str, model: Model) -> Fault:
    path = ("vary", name)
    if name in model.axes:
        alternatives = ", ".join(model.axes[name])
        text = f'"{name}" is no parameter but an axis of configurations; a study takes these as configurations:'
        return Fault(f"{text} {alternatives}", path, on_key=True, kind="unknown-parameter", about=name)
    value = value_of_entry(model.definition, name)
    if value is not None and value.names:
        used = ", ".join(sorted(value.names))
        text = f'"{name}" follows from parameters, it is "{value}"; vary {used}'
        return Fault(text, path, on_key=True, kind="unknown-parameter", about=name, meant=used)
    element, _, key = name.rpartition(".")
    if element in model.definition.elements:
        return _no_entry(model.definition.elements[element], key, path)
    return unknown_name("parameter", name, model.parameters, path, on_key=True)


def _no_entry(element: Element, key: str, path: EntryPath) -> Fault:
    """Fault of a varied entry of an element that has no value in the model or does not exist."""
    varying = [name for name, spec in element.specs() if isinstance(spec, QuantityKind)]
    if key in varying:
        text = f"{element.name} has no {key} in the model; give it a value there, then it can vary"
        return Fault(text, path, on_key=True, kind="missing-entry")
    return unknown_name(f"value of {element.name}", key, varying, path, on_key=True)


def _sampling_faults(vary: Mapping[str, Variation], sampling: Samples | None) -> list[Fault]:
    if sampling is None:
        return []
    remark = sampling.remark()
    faults = [] if remark is None else [remark]
    if not any(variation.is_random for variation in vary.values()):
        text = "nothing is drawn: all parameters take the values of a list or range; leave sampling out"
        faults.append(Fault(text, on_key=True, kind="needless-entry"))
    return faults


def _root(
    vary: Mapping[str, Variation], correlation: Sequence[Correlation], marginals: Mapping[str, Marginal]
) -> tuple[FloatArray | None, list[Fault]]:
    random = [name for name, variation in vary.items() if variation.is_random]
    faults = name_faults(correlation, random, [name for name in vary if name not in random])
    are_bound = all(name in marginals for pair in correlation for name in pair.between)
    if faults or not correlation or not are_bound:
        return None, faults
    matrix, faults = normal_correlation(correlation, marginals)
    return (None if faults else np.asarray(np.linalg.cholesky(matrix), dtype=float)), faults


# Entries of a study file that say what varies, on parameters, their correlation and their sampling.

VARY = Named(
    "what varies, by name: parameters, and values of elements (shaft.stiffness)",
    Typed(
        "how a parameter varies", lambda: VARIATIONS, "variation", "variation", shown="{type: normal, deviation: 5 %}"
    ),
    form="parameters and how they vary, k_1: {type: normal, deviation: 5 %}",
    fewest=1,
)
CORRELATION = Listed(
    "which parameters vary together",
    Nested("parameters that vary together", lambda: Correlation, "correlation"),
    form="a list of {between: [k_1, k_2], coefficient: 0.6}",
)
SAMPLING = Nested("how variants are drawn", lambda: Samples, "sampling", shown=Samples.form)


@dataclass(frozen=True, kw_only=True)
class SpaceEntries(Declared):
    """Varied parameters of a study, their correlation and their sampling."""

    kind: ClassVar[str] = "space"
    article: ClassVar[str] = "a space of variants"
    form: ClassVar[str] = "{vary: {k_1: {type: normal, deviation: 5 %}}, sampling: {count: 1000}}"

    vary: Mapping[str, Variation] = entry(VARY)
    correlation: tuple[Correlation, ...] = entry(CORRELATION, ())
    sampling: Samples | None = entry(SAMPLING, None)


# Space of the variants of a study, which gives the values of the varied parameters by the index of a variant.

COVERAGE = 0.9973
"""Share of the values within the tolerance of a distribution that has no limits of its own.

Three standard deviations of a normal one to both sides.
"""


class Space:
    """Variants of a model, with parameters drawn from distributions and crossed with lists and ranges.

    Variant i depends on i alone: on nothing that was asked for before, nor on who asks.

    Parameters
    ----------
    model : Drivetrain
        Model whose values percentages refer to.
    vary : mapping
        Parameter -> variation.
    correlation : sequence of Correlation, optional
    sampling : Samples, optional
        Without it no variants are drawn (``count`` is 0 if anything has a distribution), but answers that choose
        variants themselves have their space.

    Raises
    ------
    ModelError
        With everything that is wrong.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.study.space.variations.uniform import Uniform
    >>> from torsionnet.study.space.variations.uniform import ListOfValues
    >>> space = Space(tn.load("amt_rig"), {"k_2": Uniform(low="-10 %", high="+10 %"),
    ...     "c_O": ListOfValues(values=[170, 360])}, sampling=Samples(count=3))
    >>> space.count, space.values(2, 4)["c_O"]
    (6, array([170., 360.]))
    """

    def __init__(
        self,
        model: Model,
        vary: Mapping[str, Variation],
        correlation: Sequence[Correlation] = (),
        sampling: Samples | None = None,
    ) -> None:
        entries = SpaceEntries(vary=vary, correlation=tuple(correlation), sampling=sampling)
        bound, faults = bound_space(entries.vary, entries.correlation, entries.sampling, model)
        if bound is None:
            raise ModelError(faults, "the space of variants")
        self.entries, self._bound, self.remarks = entries, bound, tuple(faults)
        """Entries of the space, distributions and axes in SI, and warnings about the entries."""

    @classmethod
    def of(cls, entries: SpaceEntries, model: Model) -> tuple[Self | None, list[Fault]]:
        """Space of variants made from entries that were read, None with an error, and all faults found."""
        try:
            space = cls(model, entries.vary, entries.correlation, entries.sampling)
        except ModelError as error:
            return None, list(error.faults)
        return space, list(space.remarks)

    def at(self, model: Model) -> Self:
        """Space of the same variants for another model or configuration, relative to its values."""
        new, faults = self.of(self.entries, model)
        if new is None:
            raise ModelError(faults, "the space of variants")
        return new

    def to_data(self) -> dict[str, Json]:
        """Entries of a study file that make this space, as JSON data."""
        return self.entries.written_entries()

    @property
    def sampling(self) -> Samples | None:
        return self.entries.sampling

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that vary, in the order in which they were given."""
        return tuple(self.entries.vary)

    @property
    def marginals(self) -> Mapping[str, Marginal]:
        """Distribution of each parameter that has one, by its name."""
        return MappingProxyType(self._bound.joint.marginals)

    @property
    def random_names(self) -> tuple[str, ...]:
        """Names of the parameters that have a distribution."""
        return tuple(self._bound.joint.marginals)

    @property
    def grid(self) -> Mapping[str, GridAxis]:
        """Axis of values of each parameter with a list or range, by its name; the last one changes first."""
        return MappingProxyType(self._bound.axes)

    @property
    def nominal(self) -> Mapping[str, float]:
        """Value in SI of each varied parameter in the model, by name, NaN where it follows the operating point."""
        return MappingProxyType(self._bound.nominal)

    @cached_property
    def draws(self) -> int:
        """Number of draws of the parameters with a distribution, 1 where there are none."""
        if not self.random_names:
            return 1
        return self.sampling.count if self.sampling else 0

    @cached_property
    def count(self) -> int:
        """Number of variants in the space, for each point of the grid all draws."""
        return prod(axis.count for axis in self.grid.values()) * self.draws

    def values(self, start: int, stop: int) -> dict[str, FloatArray]:
        """Values (stop - start,) in SI of every parameter, by its name, in the variants ``start`` to ``stop - 1``."""
        if not 0 <= start <= stop <= self.count:
            raise IndexError(f"variants are 0 to {self.count - 1}, asked for {start} to {stop - 1}")
        if start == stop:
            return {name: np.empty(0) for name in self.names}
        # Draws are the fastest digit of a variant's number; grid points follow.
        point, draw = divmod(start, self.draws)
        places = draw + np.arange(stop - start)
        values = self._on_grid(point, places // self.draws) | self._drawn(draw, stop - start)
        return {name: values[name] for name in self.names}

    def _on_grid(self, point: int, further: Any) -> dict[str, FloatArray]:
        """Values (n,) in SI of each grid parameter at points ``further`` (n,) steps after the point with an index."""
        values = {}
        # Digits of mixed bases, the last axis the lowest.
        for name, axis in reversed(list(self.grid.items())):
            point, digit = divmod(point, axis.count)
            further, places = np.divmod(digit + further, axis.count)
            values[name] = axis.at(places)
        return values

    def _drawn(self, draw: int, count: int) -> dict[str, FloatArray]:
        if self.sampling is None or not self.random_names:
            return {}
        points = self.sampling.points(self.random_names)
        ends = draw + count
        if ends <= self.draws:
            return self.from_unit(points(draw, ends))
        if count < self.draws:
            # The stretch passes the end of the draws once.
            return self.from_unit(np.concatenate([points(draw, self.draws), points(0, ends - self.draws)]))
        all_of_them = self.from_unit(points(0, self.draws))
        places = np.arange(draw, ends) % self.draws
        return {name: column[places] for name, column in all_of_them.items()}

    def from_unit(self, shares: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each of the :attr:`random_names` at points (n, n_random) of the unit cube."""
        return self._bound.joint.from_unit(shares)

    def from_standard_normal(self, normal: FloatArray) -> dict[str, FloatArray]:
        """Values (n,) in SI of each of the :attr:`random_names` at standard normal variables (n, n_random)."""
        return self._bound.joint.from_standard_normal(normal)

    def to_standard_normal(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Independent standard normal variables (n, n_random) of values (n,) in SI of the :attr:`random_names`."""
        return self._bound.joint.to_standard_normal(values)

    def log_density(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Logarithm (n,) of the joint probability density of the :attr:`random_names` at values (n,) in SI."""
        return self._bound.joint.log_density(values)

    def box(self, coverage: float = COVERAGE) -> dict[str, tuple[float, float]]:
        """Lowest and highest value in SI of every varied parameter, by its name.

        A distribution without a limit on a side ends there where all but ``(1 - coverage)/2`` of its values do.
        """
        tail = (1 - coverage) / 2
        ranges = {name: (axis.low, axis.high) for name, axis in self.grid.items()}
        for name, marginal in self.marginals.items():
            low = marginal.low if np.isfinite(marginal.low) else float(marginal.ppf(tail))
            ranges[name] = (low, marginal.high if np.isfinite(marginal.high) else float(marginal.isf(tail)))
        return {name: ranges[name] for name in self.names}
