"""Values that a space of variants reaches and that no model can have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf

from torsionnet.core.entries.scalars import PhysicalQuantity
from torsionnet.core.errors import Fault
from torsionnet.model.model import Model
from torsionnet.study.space.parameter_uses import parameter_uses
from torsionnet.study.space.variations.grid_axis import GridAxis
from torsionnet.study.space.variations.marginal import Marginal

NEGLIGIBLE = 1e-9
"""Share of the variants that may be impossible without being talked about."""


def unreachable(model: Model, marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]) -> list[Fault]:
    """Errors of what a model would refuse, warnings of what is outside the bounds of a parameter.

    Only parameters that are themselves a value of an element are looked at; what is calculated from several is seen
    where the variants are made.
    """
    uses = parameter_uses(model)
    faults: list[Fault] = []
    for name in (*marginals, *axes):
        found = [fault for use in uses.get(name, ()) for fault in _impossible(name, use.quantity, marginals, axes)]
        bounds = model.parameter_definitions[name].bounds
        if bounds and not found:
            found = [replace(fault, severity="warning") for fault in _outside(name, bounds, marginals, axes)]
        faults += [fault.under("vary", name) for fault in found]
    return faults


def _impossible(
    name: str, spec: PhysicalQuantity, marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]
) -> Iterator[Fault]:
    if name in axes:
        ends = (axes[name].low, axes[name].high)
        reasons = {value: reason for value in ends if (reason := spec.bound_fault(value))}
        for value, reason in reasons.items():
            yield Fault(f"{name} would be {value:g}: {spec.description} {reason}")
        passes = spec.nonzero and not reasons and ends[0] < 0 < ends[1]
    else:
        if spec.lower is not None:
            reason = spec.bound_fault(spec.lower - 1)
            yield from _tails(name, marginals[name], spec.lower, inf, f"{spec.description} {reason}")
        sides = float(marginals[name].cdf(0.0)), float(marginals[name].sf(0.0))
        passes = spec.nonzero and min(sides) > NEGLIGIBLE
    if passes:
        yield Fault(f"{name} would pass through 0: {spec.description} must not be zero; keep it on one side")


def _outside(
    name: str, bounds: tuple[float, float], marginals: Mapping[str, Marginal], axes: Mapping[str, GridAxis]
) -> Iterator[Fault]:
    text = f"its bounds in the model are {bounds[0]:g} to {bounds[1]:g}"
    if name in marginals:
        yield from _tails(name, marginals[name], *bounds, text)
        return
    ends = dict.fromkeys(value for value in (axes[name].low, axes[name].high) if not bounds[0] <= value <= bounds[1])
    if ends:
        yield Fault(f"{name} would be {' and '.join(f'{value:g}' for value in ends)}; {text}")


def _tails(name: str, marginal: Marginal, lower: float, upper: float, what: str) -> Iterator[Fault]:
    """Shares of the values below and above what is possible."""
    tails = (marginal.cdf(lower), "below", lower, "low"), (marginal.sf(upper), "above", upper, "high")
    for share, side, limit, key in tails:
        if share > NEGLIGIBLE:
            text = f"{100 * float(share):.2g} % of {name} would be {side} {limit:g} ({what})"
            yield Fault(f"{text}; give {key}: {limit:g} to truncate")
