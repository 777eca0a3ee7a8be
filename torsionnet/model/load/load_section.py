"""Entry ``load:`` of a model: who absorbs, and who drives with which share."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeVar, cast

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Json, Plural, Schema, entry
from torsionnet.base.errors import LEAVE_OUT, Fault, Remedy, UsageError, got
from torsionnet.base.units import RPM
from torsionnet.model.operating_point import DriverName, TorquePlace, place_fault

# Absorbers of power in a drivetrain, and the law of their torque over speed.

A = TypeVar("A", bound="Absorber")
_SPEED = Value("a speed", "speed", below=1e6)
_TORQUE = Value("its torque", "torque")
_TORQUES = "{300 rpm: 30 kN*m, 750 rpm: 188 kN*m}"
MOST_EXPONENT = 10
"""Largest exponent of a torque over speed that a load accepts, as 1 to 3 are usual."""


@dataclass(frozen=True, eq=False, repr=False)
class TableOverSpeed(Plural[tuple[tuple[float, float], ...]]):
    """Entry of a table over speed, as of torque, stored as pairs of rad/s and the value in SI, by rising speed.

    A file has ``{300 rpm: 30 kN*m, 750 rpm: 188 kN*m}``.
    """

    of: Value
    shown: str
    """Example of the table as it stands in a file."""

    absent: ClassVar[Any] = ()

    def read(self, raw: object) -> tuple[tuple[tuple[float, float], ...], list[Fault]]:
        if isinstance(raw, tuple):
            return raw, []
        if not isinstance(raw, Mapping) or len(raw) < 2:
            text = f"expected two speeds or more, each with {self.of.description}: {self.example}; {got(raw)}"
            return (), [Fault(text, kind="wrong-form")]
        table: dict[float, float] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            try:
                speed = _SPEED.coerce(key)
            except EntryError as error:
                faults.append(replace(error.fault, path=(key,), on_key=True))
                continue
            if speed in table:
                faults.append(Fault(f"the speed {key} stands twice", (key,), on_key=True, kind="repeated-name"))
            there, wrong = self.of.read(value)
            faults += [fault.under(key) for fault in wrong]
            table[speed] = cast("float", there)
        return tuple(sorted(table.items())) if not faults else (), faults

    @property
    def example(self) -> str:
        return self.shown

    def plain(self, value: Any) -> Json:
        return {f"{speed!r} rad/s": self.of.plain(there) for speed, there in value}

    def schema(self) -> Schema:
        return {"type": "object", "description": self.description, "minProperties": 2, "additionalProperties": True}


def value_over_speed(table: tuple[tuple[float, float], ...], speed: float) -> float:
    """Value in SI at a speed in rad/s of a table over speed, on straight lines between its rows.

    Raises
    ------
    UsageError
        The speed is outside the table.
    """
    speeds = [pair[0] for pair in table]
    low, high = speeds[0], speeds[-1]
    if not low * (1 - 1e-9) <= speed <= high * (1 + 1e-9):
        range_text = f"from {low * RPM:.6g} to {high * RPM:.6g} rpm"
        raise UsageError(
            f"{speed * RPM:.6g} rpm is outside the table over speed, which goes {range_text}", kind="out-of-range"
        )
    place = min(max(bisect_right(speeds, speed), 1), len(speeds) - 1)
    (before, lower), (after, upper) = table[place - 1 : place + 1]
    return float(lower + (upper - lower) * (speed - before) / (after - before))


@dataclass(frozen=True, kw_only=True)
class Absorber(Declared):
    """A consumer of power: its torque at rated speed with an exponent over speed, or a table over speed.

    Examples
    --------
    >>> screw = Absorber(power="3000 kW", torque_exponent=2, rated="151.8 rpm")
    >>> round(screw.torque_at(screw.rated)), round(screw.torque_at(screw.rated / 2))
    (188721, 47180)
    """

    kind: ClassVar[str] = "absorber"
    article: ClassVar[str] = "an absorber"
    form: ClassVar[str] = "{power: 3000 kW, torque_exponent: 2}"

    power: float | None = entry(Value("power absorbed at rated speed", "power", exclusive=True), None)
    torque: float | None = entry(Value("instead: torque absorbed at rated speed", "torque", exclusive=True), None)
    torque_exponent: float | None = entry(
        Value("torque follows (speed/rated) to this power: 2 of a propeller or fan, 0 of a hoist", "1", lower=None),
        None,
    )
    rated: float | None = entry(
        Value(
            "rated speed of this node; default: what speeds: {rated: ...} means there",
            "speed",
            exclusive=True,
        ),
        None,
    )
    over_speed: tuple[tuple[float, float], ...] = entry(
        TableOverSpeed("instead of all others: torque over the speed of this node", _TORQUE, _TORQUES), ()
    )

    def contradictions(self) -> list[Fault]:
        sizes = [name for name in ("power", "torque") if getattr(self, name) is not None]
        law = [*sizes, *(name for name in ("torque_exponent", "rated") if getattr(self, name) is not None)]
        if self.over_speed and law:
            return [
                Fault(
                    f"a table over speed says it all; leave out {' and '.join(law)}",
                    (law[0],),
                    on_key=True,
                    remedy=Remedy(LEAVE_OUT),
                    kind="needless-entry",
                )
            ]
        if not self.over_speed and len(sizes) != 1:
            text = "what is absorbed is a power or a torque at rated speed, or a table over_speed"
            return [
                Fault(
                    f"{text}; here is {'both' if sizes else 'none of them'}",
                    tuple(sizes[1:]),
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if not self.over_speed and self.torque_exponent is None:
            return [
                Fault(
                    "say how the torque follows the speed: torque_exponent: 2 of a propeller, 0 if it does not",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        if self.torque_exponent is not None and abs(self.torque_exponent) > MOST_EXPONENT:
            text = f"torque follows the speed to a power from -{MOST_EXPONENT} to {MOST_EXPONENT}"
            text += f": 2 of a propeller or fan; got {self.torque_exponent:g}"
            return [Fault(text, ("torque_exponent",), kind="out-of-range")]
        return []

    @property
    def needs_rated(self) -> bool:
        """Whether the absorber needs the rated speed of another entry."""
        return not self.over_speed and self.rated is None

    def torque_at(self, speed: float, rated: float | None = None) -> float:
        """Torque in N m that the absorber takes at a speed >= 0 of its node in rad/s.

        ``rated`` is used where it has none itself.

        Raises
        ------
        UsageError
            The speed is outside the table.
        """
        if self.over_speed:
            return value_over_speed(self.over_speed, speed)
        own: Any = self.rated or rated
        # T = T_r (omega/omega_r)^m, and T_r = P/omega_r of a power.
        at_rated = self.torque if self.torque is not None else self.power / own
        return float(at_rated * (speed / own) ** self.torque_exponent)


def _at_share(absorber: A, share: float) -> A:
    """Copy of an absorber that takes a share of its torque at every speed."""
    sizes = {name: value * share for name in ("power", "torque") if (value := getattr(absorber, name)) is not None}
    table = tuple((speed, torque * share) for speed, torque in absorber.over_speed)
    return absorber.unchecked(**sizes, over_speed=table)


_LAW = ("power", "torque", "torque_exponent", "rated", "over_speed")
_ABSORBER = Nested(
    "power or torque at rated speed with an exponent, or a table over speed", lambda: Absorber, "absorber"
)
_SHARE = Value("share of the power that this one gives, 1 or 100 % in all", "1", exclusive=True)
SHARE_ROUNDING = 1e-6
"""Largest difference from 1 of the sum of the drivers' shares, as six digits round by as much."""


@dataclass(frozen=True, kw_only=True)
class Load(Absorber):
    """Mean power in W absorbed at nodes of a drivetrain over the speed, and the drivers that give the power.

    Examples
    --------
    >>> load = Load(absorbed_at="prop", power="3000 kW", torque_exponent=2, driven_by={"fly": 1})
    >>> list(load.by_place), load.driven_by
    (['prop'], {'fly': 1.0})
    """

    kind: ClassVar[str] = "load"
    article: ClassVar[str] = "a load"
    form: ClassVar[str] = "{absorbed_at: prop, power: 3000 kW, torque_exponent: 2, driven_by: {fly: 1}}"

    absorbed_at: str | None = entry(
        TorquePlace("the node that absorbs; gen-frame: with the reaction on another node"), None
    )
    absorbers: Mapping[str, Absorber] = entry(
        Named(
            "instead: several nodes, each with what it absorbs",
            _ABSORBER,
            refused=place_fault,
            form="{prop: {power: 3 MW, torque_exponent: 2}}",
            keys=TorquePlace("a node, or two"),
        ),
        None,
    )
    driven_by: Mapping[str, float] = entry(
        Named(
            "node, two nodes as fly-block, or excitation that drives -> share of the power; default: the only engine",
            _SHARE,
            refused=place_fault,
            form="{fly: 1}",
            keys=DriverName("a node, two nodes, or an excitation"),
        ),
        None,
    )

    def contradictions(self) -> list[Fault]:
        if bool(self.absorbed_at) == bool(self.absorbers):
            text = "a load is absorbed_at one node, or has several absorbers"
            return [
                Fault(
                    f"{text}; here is {'both' if self.absorbers else 'neither'}",
                    on_key=True,
                    kind="contradicting-entries",
                )
            ]
        if self.absorbers:
            given = [name for name in _LAW if getattr(self, name) not in (None, ())]
            faults = (
                [
                    Fault(
                        f"{given[0]} belongs into one of the absorbers", (given[0],), on_key=True, kind="needless-entry"
                    )
                ]
                if given
                else []
            )
        else:
            faults = super().contradictions()
        total = sum(self.driven_by.values()) if self.driven_by else 1.0
        if abs(total - 1) > SHARE_ROUNDING:
            listed = ", ".join(f"{name} {share:g}" for name, share in self.driven_by.items())
            text = f"the shares of the drivers ({listed}) sum to {total:g}; they have to sum to 1"
            faults.append(Fault(text, ("driven_by",), kind="contradicting-values"))
        return faults

    def at_share(self, share: float) -> Load:
        """Copy of the load in which all absorbers take a share of their torque at every speed.

        Examples
        --------
        >>> Load(absorbed_at="rotor", power="4 MW", torque_exponent=0).at_share(0.15).power
        600000.0
        """
        absorbers = {place: _at_share(absorber, share) for place, absorber in (self.absorbers or {}).items()}
        return _at_share(self, share).unchecked(absorbers=absorbers)

    @property
    def by_place(self) -> Mapping[str, Absorber]:
        """Absorbers of the load by the node, or pair of nodes, at which they act."""
        return dict(self.absorbers) if self.absorbers else {str(self.absorbed_at): self}
