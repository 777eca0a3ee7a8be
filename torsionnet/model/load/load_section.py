"""Entry ``load:`` of a model: who absorbs, and who drives with which share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import Fault
from torsionnet.model.load.absorber import Absorber
from torsionnet.model.operating_point import DriverName, TorquePlace, place_fault

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
            return [Fault(f"{text}; here is {'both' if self.absorbers else 'neither'}", on_key=True)]
        if self.absorbers:
            given = [name for name in _LAW if getattr(self, name) not in (None, ())]
            faults = [Fault(f"{given[0]} belongs into one of the absorbers", (given[0],), on_key=True)] if given else []
        else:
            faults = super().contradictions()
        total = sum(self.driven_by.values()) if self.driven_by else 1.0
        if abs(total - 1) > SHARE_ROUNDING:
            listed = ", ".join(f"{name} {share:g}" for name, share in self.driven_by.items())
            text = f"the shares of the drivers ({listed}) sum to {total:g}; they have to sum to 1"
            faults.append(Fault(text, ("driven_by",)))
        return faults

    @property
    def by_place(self) -> Mapping[str, Absorber]:
        """Absorbers of the load by the node, or pair of nodes, at which they act."""
        return dict(self.absorbers) if self.absorbers else {str(self.absorbed_at): self}
