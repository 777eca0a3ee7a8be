"""Conversion of element values quoted at the speed of another shaft to their own, and faults of such values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, TorsionnetError
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.element_base.laws import own_node
from torsionnet.model.element_base.speed_path import LawsAtOwnShaft, SpeedPath, SpeedPaths, second_ratio
from torsionnet.model.elements import Element, Law, Values


def at_own_speeds(elements: Sequence[Element], values: Mapping[str, Any]) -> tuple[Element, ...]:
    """Elements of a drivetrain with values converted from the shaft where they are quoted to their own shafts.

    Elements without a ratio are unchanged.

    Parameters
    ----------
    elements : sequence of Element
        Elements that are switched on.
    values : mapping
        Exact values of the parameters.
    """
    try:
        paths = SpeedPaths(elements, Values(values))
        paired = [(element, _path(element, paths)) for element in elements]
    except (TorsionnetError, ArithmeticError, KeyError):  # checks say which values are missing or impossible
        return tuple(elements)
    return tuple(
        element if path is None else element.with_laws(LawsAtOwnShaft(element, path)) for element, path in paired
    )


def _path(element: Element, paths: SpeedPaths) -> SpeedPath | None:
    if element.referred_to is None or element.is_at_own_speed:
        return None
    return paths.between(own_node(element.ports), element.referred_to)


def referral_faults(elements: Sequence[Element], values: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of elements whose values are quoted at a shaft without a single ratio; all names must exist."""
    quoted = [element for element in elements if element.referred_to is not None]
    paths = SpeedPaths(elements, Values(values)) if quoted else None
    for element in quoted:
        path = ("elements", element.name, "referred_to")
        own = own_node(element.ports)
        tabled = any(isinstance(part, Law) and part.table for part in element.parts(Values(values)))
        said = "{} has a table over frequency; give it at its own shaft, {}"
        reason = phrase(said, ModelName(element.name), ModelName(own)) if tabled else element.referral_fault
        if reason is None and paths is not None and paths.between(own, not_none(element.referred_to)) is None:
            reason = phrase(
                "no ratio leads from {} to {}: in between is an open clutch or gearbox, or a "
                "planetary set with two free members; give the values of {} at its own shaft",
                *map(ModelName, (own, not_none(element.referred_to), element.name)),
            )
        if reason is None and paths is not None:
            reason = _two_ratios(element, paths, own)
        if reason is not None:
            yield Fault(reason, path, kind="no-ratio")


def _two_ratios(element: Element, paths: SpeedPaths, own: str) -> str | None:
    """Message if two ratios lead to the shaft, as over a spring beside gears, else None."""
    end = str(element.referred_to)
    tree, path = paths.tree(own, end), paths.between(own, end)
    if not tree.closing or path is None:
        return None
    try:
        first, second = path.ratio(paths.value), second_ratio(tree, own, paths.value)
    except ArithmeticError:  # a ratio of zero, which other checks tell
        return None
    if second is None:
        return None
    return phrase(
        "two ways lead from {0} to {1}, and {1} turns {2:.6g} or {3:.6g} times as fast "
        "as {0} by them; give the values of {4} at its own shaft, {0}, without referred_to",
        ModelName(own), ModelName(end), float(first), float(second), ModelName(element.name),
    )  # fmt: skip
