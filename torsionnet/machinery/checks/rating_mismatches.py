"""Check of powers and speeds that are stated several times along a drivetrain and do not agree."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from torsionnet.base.errors import EntryPath, Fault, UsageError, question
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations import OrderExcitation
from torsionnet.machinery.excitations.order_excitation import Rating
from torsionnet.model.definition import LOAD
from torsionnet.model.load.external_torques import ENGINE, ExternalTorques

# Likely causes of a power or speed that does not agree with others: a wrong unit, or the shaft of another node.

LIKELY_POWER_SHARE = 0.35
"""Relative difference up to which two powers count as the same, as an indicated power is up to a third higher. Slips of
a unit differ by far more."""
LIKELY_SPEED_SHARE = 0.005
"""Relative difference up to which two speeds count as equal, as data sheets round to about half a percent."""
_THOUSANDS = {
    1e-6: "a unit a million times larger",
    1e-3: "kW for MW, or W for kW",
    1e3: "MW for kW, or kW for W",
    1e6: "a unit a million times smaller",
}
"""Likely slip of the unit of a power, as text, by the factor between the stated and the expected value."""
_OF_TORQUE = {
    1e-6: "a unit a million times larger",
    1e-3: "N*m for kN*m",
    1e3: "kN*m for N*m",
    1e6: "a unit a million times smaller",
}
"""Likely slip of the unit of a torque, as text, by the factor between the stated and the expected value."""


def power_text(watts: float) -> str:
    """Text of a power given in W, in the unit that suits its size.

    >>> power_text(3e6), power_text(3e3), power_text(2.0)
    ('3000 kW', '3 kW', '2 W')
    """
    return f"{_short(watts / 1e3)} kW" if watts >= 100 else f"{_short(watts)} W"


def _short(value: float) -> str:
    """Text of a number with four digits, in which a difference of 5 % shows."""
    return f"{float(f'{value:.4g}'):.10g}"


Likely: TypeAlias = tuple[str, str]
"""Type of a question on a likely slip and the value that it asks for, both empty where none is likely."""


def likely_speed(stated: float, expected: float, node: str, known: Mapping[str, float]) -> Likely:
    """Question whether a speed in rad/s is that of another node, or in a wrong unit."""
    meant = f"{expected * RPM:.6g} rpm"
    other = next(
        (name for name, speed in known.items() if name != node and _is(stated, speed, LIKELY_SPEED_SHARE)), None
    )
    if other is not None:
        return f": that is the speed of {other}{question(meant)}", meant
    if _is(stated * RPM, expected, LIKELY_SPEED_SHARE):
        return f': rad/s for rpm? Did you mean "{meant}"?', meant
    if _is(stated, expected * RPM, LIKELY_SPEED_SHARE):
        return f': rpm for rad/s? Did you mean "{meant}"?', meant
    return "", ""


def likely_power(stated: float, expected: float, rating: Rating, ratios: Mapping[str, float]) -> Likely:
    """Question whether a power in W that is stated has a likely slip."""
    of_torque = rating.power is None and rating.shares == (1.0, 1.0)
    share = stated / expected
    slips = _OF_TORQUE if of_torque else _THOUSANDS
    near = LIKELY_POWER_SHARE if rating.shares[0] < 1 else LIKELY_POWER_SHARE / 2
    # Stated over expected is near a factor of a thousand or a million: a prefix that was mistaken.
    slip = next((text for factor, text in slips.items() if _is(share, factor, near)), None)
    if slip is not None:
        if rating.power is None and not of_torque:
            return "; is the load in the right unit?", ""
        right = f"{_short(abs(rating.torque) / share / 1e3)} kN*m" if of_torque else power_text(expected)
        return f'; {slip}? Did you mean "{right}"?', right
    if of_torque:
        # A torque on the wrong side of a gear is off by its ratio.
        side = next(
            (node for node, ratio in ratios.items() if _is(share * ratio, 1, 0.01) and not _is(ratio, 1, 0.05)), ""
        )
        if side:
            right = f"{_short(abs(rating.torque) / share / 1e3)} kN*m"
            return f"; that is the torque at {side}{question(right)}", right
    return "; one of them is wrong" if share > 10 or share < 0.1 else "", ""


def likely_load(power: float, share: float, torque: float | None) -> Likely:
    """Question whether a load in W has the right unit, if its power is stated elsewhere as ``share`` times as much."""
    slip = next((text for factor, text in (_THOUSANDS if torque is None else _OF_TORQUE).items()
                  if _is(1 / share, factor, LIKELY_POWER_SHARE)), None)  # fmt: skip
    if slip is None:
        return "", ""
    factor = 10.0 ** round(math.log10(share))
    right = power_text(power * factor) if torque is None else f"{_short(torque * factor / 1e3)} kN*m"
    return f'; {slip}? Did you mean "{right}"?', right


def _is(value: float, other: float, share: float) -> bool:
    return abs(math.log(value / other)) <= math.log1p(share) if value > 0 and other > 0 else False


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
    unlike = [*_absorbed(external, machines, work), *_weak_engines(external, machines, work)]
    return faults + (_of_load(external, unlike, work) or [mismatch.fault for mismatch in unlike])


def _ratios(external: ExternalTorques) -> dict[str, float]:
    """Absolute ratio of every node's speed to that of the reference node, by node, the latter first."""
    ratios = {node: abs(ratio) for node, ratio in external.ratios.items() if ratio}
    return {external.reference: 1.0, **ratios}


def _of_load(external: ExternalTorques, unlike: Sequence[_Unlike], work: Mapping[str, float]) -> list[Fault]:
    """Warning about the load, where one slip in its unit explains the differences to two machines or more."""
    load, sizes = external.definition.load, [mismatch.share for mismatch in unlike]
    # The same ratio at several machines points to the one value that they are compared with.
    if load is None or load.absorbers or len(sizes) < 2 or max(sizes) > (1 + SAME_SLIP_SHARE) * min(sizes):
        return []
    entry = next((name for name in ("power", "torque") if getattr(load, name) is not None), "over_speed")
    stated = " and ".join(f"{mismatch.machine.name} {power_text(mismatch.machine.powers[0])}" for mismatch in unlike)
    text = f"the load takes {power_text(_taken(work))} at rated speed, but stated are of {stated}"
    cause, meant = likely_load(_taken(work), min(sizes), getattr(load, entry) if entry == "torque" else None)
    return [Fault(text + cause, ("load", entry), "warning", meant=meant, kind="contradicting-values")] if cause else []


def _machines(external: ExternalTorques, rated: float) -> Iterator[_Machine]:
    for name, excitation in external.definition.excitations.items():
        rating, ratio = excitation.rating if excitation.enabled else None, external.ratios.get(excitation.shaft)
        if rating is not None and rating.torque and ratio:
            yield _Machine(name, excitation, rating, abs(ratio) * rated)


def _powers(external: ExternalTorques, rated: float) -> dict[str, float]:
    """Power in W, by node, that the load gives or takes at rated speed; empty without a load."""
    if external.definition.load is None:
        return {}
    return {node: torque * external.ratios.get(node, 0.0) * rated for node, torque in external.at(rated).items()}


def _speeds(external: ExternalTorques, machines: list[_Machine], rated: float) -> Iterator[Fault]:
    """Warnings about rated speeds that do not follow from that of the reference shaft by the gear ratios."""
    known = {node: ratio * rated for node, ratio in _ratios(external).items()}
    for machine in machines:
        if machine.rating.speed:
            yield from _unlike(
                external, machine.path(machine.rating.speed_path), machine.rating.speed, machine.excitation.shaft, known
            )
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
        yield Fault(text + cause, path, "warning", meant=meant, kind="contradicting-values")


def _absorbed(external: ExternalTorques, machines: list[_Machine], work: Mapping[str, float]) -> Iterator[_Unlike]:
    """Machines that state another power than the load takes at their nodes, with their faults."""
    absorbers = [machine for machine in machines if not machine.is_driver]
    for machine in absorbers if work else ():
        taken = -sum(work.get(node, 0.0) for node in machine.excitation.nodes)
        if taken <= 0 and len(absorbers) == 1 and len(external.absorbers) == 1:
            taken = _taken(work)
        if taken > 0 and not any(_agree(power, taken, machine.rating.shares) for power in machine.powers):
            text = f"{machine.name} takes {power_text(machine.powers[0])} at rated speed"
            text += f", the load there {power_text(taken)}"
            cause, meant = _cause(machine, taken, external)
            fault = Fault(
                text + cause,
                machine.path(machine.rating.path),
                "warning",
                about=LOAD,
                meant=meant,
                kind="contradicting-values",
            )
            yield _Unlike(machine, machine.powers[0] / taken, fault)


def _weak_engines(external: ExternalTorques, machines: list[_Machine], work: Mapping[str, float]) -> Iterator[_Unlike]:
    """Engines that give less power than is taken from them, with notes on those that could give more."""
    propellers = [machine for machine in machines if machine.excitation.kind == PROPELLER]
    total = _taken(work) if work else sum(machine.powers[0] for machine in propellers)
    engines = [machine for machine in machines if machine.is_driver]
    for engine in engines:
        share = _share(external, engine, len(engines))
        if not share or not total or any(_agree(power, share * total, engine.rating.shares) for power in engine.powers):
            continue
        wanted, given = share * total, engine.powers[0]
        indicated = " indicated" if engine.rating.shares[0] < 1 else ""
        text = f"{engine.name} gives {power_text(given)}{indicated} at rated speed"
        text += f", {'the load takes' if work else 'propellers take'} {power_text(wanted)} from it"
        cause, meant = _cause(engine, wanted, external)
        least = given * engine.rating.shares[0]
        severity = "note" if least > wanted and not cause else "warning"
        fault = Fault(
            text + cause,
            engine.path(engine.rating.path),
            severity,
            about=LOAD,
            meant=meant,
            kind="contradicting-values",
        )
        yield _Unlike(engine, given / wanted, fault)


def _taken(work: Mapping[str, float]) -> float:
    return -sum(min(0.0, power) for power in work.values())


def _share(external: ExternalTorques, engine: _Machine, engines: int) -> float | None:
    """Share of the load's power that an engine gives; None where the load does not say."""
    load = external.definition.load
    if load is None or not load.driven_by:
        return 1.0 if engines == 1 else None
    named = {
        name: share for name, share in load.driven_by.items() if name == engine.name or name in engine.excitation.nodes
    }
    if named:
        return float(sum(named.values()))
    return 1.0 if engines == 1 and len(load.driven_by) == 1 and engine.excitation.kind == ENGINE else None


def _agree(stated: float, expected: float, shares: tuple[float, float]) -> bool:
    low, high = (share * stated for share in shares)
    return low * (1 - SAME_POWER_SHARE) <= expected <= high * (1 + SAME_POWER_SHARE)


def _cause(machine: _Machine, wanted: float, external: ExternalTorques) -> Likely:
    if math.isclose(machine.powers[0], 0.0):
        return "", ""
    ratios = _ratios(external)
    own = ratios[machine.excitation.shaft]
    return likely_power(
        machine.powers[0], wanted, machine.rating, {node: ratio / own for node, ratio in ratios.items()}
    )
