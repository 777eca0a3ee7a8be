"""Check of powers and speeds that are stated several times along a drivetrain and do not agree."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from torsionnet.base.errors import EntryPath, Fault, UsageError
from torsionnet.base.units import RPM
from torsionnet.machinery.checks.likely_mistakes import Likely, likely_load, likely_power, likely_speed, power_text
from torsionnet.machinery.excitations import OrderExcitation
from torsionnet.machinery.excitations.rating import Rating
from torsionnet.model.definition import LOAD
from torsionnet.model.load.external_torques import ENGINE, ExternalTorques

SAME_POWER_SHARE, SAME_SPEED_SHARE = 0.05, 0.005
"""Relative differences up to which powers and speeds agree, for rounding of data sheets and slip."""
SAME_SLIP_SHARE = 0.4
"""Relative spread of machines' powers over the load up to which one slip of the load's unit explains all: indicated
powers are above those at the coupling."""
PROPELLER = "propeller"
"""Type of the excitation by a propeller, as in ``type:``."""


@dataclass(frozen=True)
class _Machine:
    """Machine of an excitation that states a rating, and the speed in rad/s that its shaft has at rated speed."""

    name: str
    excitation: OrderExcitation
    rating: Rating
    speed: float

    @property
    def is_driver(self) -> bool:
        return self.rating.torque > 0

    @property
    def powers(self) -> tuple[float, ...]:
        """Powers in W of the machine at rated speed, as stated and by its torque curve."""
        return tuple(map(abs, self.rating.at(self.speed)))

    def path(self, entry: EntryPath) -> EntryPath:
        return ("excitations", self.name, *entry)


@dataclass(frozen=True)
class _Unlike:
    """Fault of a machine whose power does not agree with others, and its power over the expected one."""

    machine: _Machine
    share: float
    fault: Fault


def rating_mismatches(external: ExternalTorques) -> list[Fault]:
    """Warnings about rated speeds that differ by more than 0.5 %, and powers that differ by more than 5 %.

    All are those at rated speed. That an engine gives more than is taken from it is a note.
    """
    rated = external.rated_speed
    if not rated:
        return []
    machines = list(_machines(external, rated))
    try:
        work = _powers(external, rated)
    except UsageError:  # said of the load itself
        return []
    faults = list(_speeds(external, machines, rated))
    if any(fault.path[0] == LOAD for fault in faults):  # its power at rated speed follows from that
        return faults
    unlike = [*_absorbed(external, machines, work), *_given(external, machines, work)]
    return faults + (_of_load(external, unlike, work) or [one.fault for one in unlike])


def _ratios(external: ExternalTorques) -> dict[str, float]:
    """Absolute ratio of every node's speed to that of the reference node, by node, the latter first."""
    found = {node: abs(ratio) for node, ratio in external.ratios.items() if ratio}
    return {external.reference: 1.0, **found}


def _of_load(external: ExternalTorques, unlike: Sequence[_Unlike], work: Mapping[str, float]) -> list[Fault]:
    """Warning about the load, where one slip in its unit explains the differences to two machines or more."""
    load, sizes = external.definition.load, [one.share for one in unlike]
    if load is None or load.absorbers or len(sizes) < 2 or max(sizes) > (1 + SAME_SLIP_SHARE) * min(sizes):
        return []
    entry = next((name for name in ("power", "torque") if getattr(load, name) is not None), "over_speed")
    stated = " and ".join(f"{one.machine.name} {power_text(one.machine.powers[0])}" for one in unlike)
    text = f"the load takes {power_text(_taken(work))} at rated speed, but stated are of {stated}"
    cause, meant = likely_load(_taken(work), min(sizes), getattr(load, entry) if entry == "torque" else None)
    return [Fault(text + cause, ("load", entry), "warning", meant=meant)] if cause else []


def _machines(external: ExternalTorques, rated: float) -> Iterator[_Machine]:
    for name, one in external.definition.excitations.items():
        rating, ratio = one.rating if one.enabled else None, external.ratios.get(one.shaft)
        if rating is not None and rating.torque and ratio:
            yield _Machine(name, one, rating, abs(ratio) * rated)


def _powers(external: ExternalTorques, rated: float) -> dict[str, float]:
    """Power in W, by node, that the load gives or takes at rated speed; empty without a load."""
    if external.definition.load is None:
        return {}
    return {node: torque * external.ratios.get(node, 0.0) * rated for node, torque in external.at(rated).items()}


def _speeds(external: ExternalTorques, machines: list[_Machine], rated: float) -> Iterator[Fault]:
    """Warnings about rated speeds that do not follow from that of the reference shaft by the gear ratios."""
    known = {node: ratio * rated for node, ratio in _ratios(external).items()}
    for one in machines:
        if one.rating.speed:
            yield from _unlike(external, one.path(one.rating.speed_path), one.rating.speed, one.excitation.shaft, known)
    load = external.definition.load
    for place, absorber in zip(load.by_place if load else (), external.absorbers.items(), strict=True):
        path: EntryPath = ("load", "absorbers", place, "rated") if load and load.absorbers else ("load", "rated")
        where, law = absorber
        if law.rated and where.against is None and where.of in known:
            yield from _unlike(external, path, law.rated, where.of, known)


def _unlike(
    external: ExternalTorques, path: EntryPath, stated: float, node: str, known: Mapping[str, float]
) -> Iterator[Fault]:
    expected = known[node]
    if abs(stated - expected) > SAME_SPEED_SHARE * expected:
        text = f"a rated speed of {stated * RPM:.6g} rpm, but {node} turns at {expected * RPM:.6g} rpm"
        text += f" with {external.reference} at its rated {known[external.reference] * RPM:.6g} rpm"
        cause, meant = likely_speed(stated, expected, node, known)
        yield Fault(text + cause, path, "warning", meant=meant)


def _absorbed(external: ExternalTorques, machines: list[_Machine], work: Mapping[str, float]) -> Iterator[_Unlike]:
    """Machines that state another power than the load takes at their nodes, with their faults."""
    absorbers = [one for one in machines if not one.is_driver]
    for one in absorbers if work else ():
        taken = -sum(work.get(node, 0.0) for node in one.excitation.nodes)
        if taken <= 0 and len(absorbers) == 1 and len(external.absorbers) == 1:
            taken = _taken(work)
        if taken > 0 and not any(_agree(power, taken, one.rating.shares) for power in one.powers):
            text = f"{one.name} takes {power_text(one.powers[0])} at rated speed"
            text += f", the load there {power_text(taken)}"
            cause, meant = _cause(one, taken, external)
            fault = Fault(text + cause, one.path(one.rating.path), "warning", about=LOAD, meant=meant)
            yield _Unlike(one, one.powers[0] / taken, fault)


def _given(external: ExternalTorques, machines: list[_Machine], work: Mapping[str, float]) -> Iterator[_Unlike]:
    """Engines that give less power than is taken from them, with notes on those that could give more."""
    propellers = [one for one in machines if one.excitation.kind == PROPELLER]
    total = _taken(work) if work else sum(one.powers[0] for one in propellers)
    engines = [one for one in machines if one.is_driver]
    for one in engines:
        share = _share(external, one, len(engines))
        if not share or not total or any(_agree(power, share * total, one.rating.shares) for power in one.powers):
            continue
        wanted, given = share * total, one.powers[0]
        indicated = " indicated" if one.rating.shares[0] < 1 else ""
        text = f"{one.name} gives {power_text(given)}{indicated} at rated speed"
        text += f", {'the load takes' if work else 'propellers take'} {power_text(wanted)} from it"
        cause, meant = _cause(one, wanted, external)
        least = given * one.rating.shares[0]
        severity = "note" if least > wanted and not cause else "warning"
        fault = Fault(text + cause, one.path(one.rating.path), severity, about=LOAD, meant=meant)
        yield _Unlike(one, given / wanted, fault)


def _taken(work: Mapping[str, float]) -> float:
    return -sum(min(0.0, power) for power in work.values())


def _share(external: ExternalTorques, one: _Machine, engines: int) -> float | None:
    """Share of the load's power that an engine gives; None where the load does not say."""
    load = external.definition.load
    if load is None or not load.driven_by:
        return 1.0 if engines == 1 else None
    named = {name: share for name, share in load.driven_by.items() if name == one.name or name in one.excitation.nodes}
    if named:
        return float(sum(named.values()))
    return 1.0 if engines == 1 and len(load.driven_by) == 1 and one.excitation.kind == ENGINE else None


def _agree(stated: float, expected: float, shares: tuple[float, float]) -> bool:
    low, high = (share * stated for share in shares)
    return low * (1 - SAME_POWER_SHARE) <= expected <= high * (1 + SAME_POWER_SHARE)


def _cause(one: _Machine, wanted: float, external: ExternalTorques) -> Likely:
    if math.isclose(one.powers[0], 0.0):
        return "", ""
    ratios = _ratios(external)
    own = ratios[one.excitation.shaft]
    return likely_power(one.powers[0], wanted, one.rating, {node: ratio / own for node, ratio in ratios.items()})
