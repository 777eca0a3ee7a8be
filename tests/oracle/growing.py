"""Steps in which a model grows: elements to new nodes, loops between old ones, holds."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from typing import Any

from oracle.chance import Numbers
from oracle.description import GROUND, MEMBERS, Part
from oracle.exact import null_space
from oracle.physics import conditions_of
from oracle.solution import without_ground

LONGEST = 40
"""Characters of a ratio that closes a loop; products of many ratios are left alone."""


class Growing(Numbers):
    """Parts and nodes as far as they are drawn."""

    def __init__(self, chance: random.Random) -> None:
        super().__init__(chance)
        self.parts: list[Part] = []
        self.nodes = ["n0"]

    def add(self, kind: str, **values: Any) -> None:
        self.parts.append(Part(kind, f"e{len(self.parts)}", values))

    def fresh(self) -> str:
        self.nodes.append(f"n{len(self.nodes)}")
        return self.nodes[-1]

    def node(self) -> str:
        """Any node, those at the end of the train more often."""
        return self.chance.choice(self.nodes[-3:] if self.sometimes(0.5) else self.nodes)

    def other(self, a: str) -> str:
        others = [node for node in self.nodes if node != a]
        return self.chance.choice(others) if others else self.fresh()

    def pair(self, a: str, b: str) -> tuple[str, str]:
        return (a, b) if self.sometimes(0.5) else (b, a)

    # --- elements ---------------------------------------------------------------------------------------------------

    def link(self, kind: str, a: str, b: str) -> None:
        """An element of two ports between any nodes."""
        values: dict[str, Any] = {"nodes": self.pair(a, b)}
        match kind:
            case "spring":
                values |= {"stiffness": self.k, **self.viscous(0.5)}
            case "damper":
                values["damping"] = self.c
            case "hysteretic_spring":
                values |= {"stiffness": self.k, "loss_factor": self.loss(), **self.viscous(0.4)}
            case "tabulated_spring":
                values["table"] = self.table()
            case "gear" | "compliant_gear":
                values |= self.ratio() | self.mesh(share=kind == "compliant_gear")
            case "shaft":
                values |= self.shaft()
        self.add("gear" if kind == "compliant_gear" else kind, **values)

    def join(self, kind: str, members: Sequence[str]) -> None:
        """An element of three ports between any nodes."""
        if kind == "housed_gear":
            first, second, housing = members
            self.add("gear", nodes=(first, second), housing=housing, **self.ratio(), **self.mesh(0.5))
        else:
            more = self.planetary() if kind == "planetary" else {"locked": self.sometimes(0.25)}
            self.add(kind, **dict(zip(MEMBERS[kind], members, strict=True)), **more)

    def grow(self, kind: str) -> None:
        """An element to one new node or two."""
        a = self.node()
        if kind not in ("housed_gear", *MEMBERS):
            self.link(kind, a, self.fresh())
            return
        third = GROUND if self.sometimes(0.12) else self.other(a) if self.sometimes(0.15) else self.fresh()
        members = [a, self.fresh(), third]
        self.chance.shuffle(members)
        self.join(kind, members)

    def empty(self) -> None:
        """An element that does nothing, or only half of what it could."""
        a = self.node()
        match self.chance.choice(("inertia", "damper", "spring")):
            case "inertia":
                self.add("inertia", node=a, inertia=Fraction(0))
            case "damper":
                self.add("damper", nodes=self.pair(a, self.other(a)), damping=Fraction(0))
            case _:
                more = self.viscous(0.6, measures=False)
                self.add("spring", nodes=self.pair(a, self.other(a)), stiffness=Fraction(0), **more)

    # --- loops ------------------------------------------------------------------------------------------------------

    def close(self, kind: str) -> None:
        """Tie nodes that are there already."""
        match kind:
            case "consistent_gear" | "rigid_gear":
                self.close_gear(rigid=kind == "rigid_gear")
            case "parallel":
                self.repeat()
            case "planetary" | "differential" if len(self.nodes) > 2:
                self.join(kind, self.chance.sample(self.nodes, 3))
            case "planetary" | "differential":
                pass
            case _:
                self.link(kind, *self.chance.sample(self.nodes, 2))

    def repeat(self) -> None:
        """A rigid part a second time beside itself."""
        if rigid := [part for part in self.parts if part.is_rigid]:
            part = self.chance.choice(rigid)
            self.parts.append(replace(part, name=f"e{len(self.parts)}"))

    def close_gear(self, *, rigid: bool) -> None:
        """A gear, or coupling, whose ratio agrees with what ties its nodes already."""
        if not (tied := self.tied()):
            return
        a, b, tau = self.chance.choice(tied)
        if tau == 1 and self.sometimes(0.7):
            self.add("rigid_coupling", nodes=self.pair(a, b))
        else:
            self.add("gear", nodes=(a, b), ratio=tau, **self.mesh(share=not rigid))

    def tied(self) -> list[tuple[str, str, Fraction]]:
        """Pairs of nodes that turn at a fixed ratio whether clamps are there or not."""
        motion, pairs = self.motion(clamps=False), []
        for a, b in combinations(self.nodes, 2):
            first, second = motion[a], motion[b]
            if first and first.keys() == second.keys():
                quotients = {first[name] / second[name] for name in first}
                if len(quotients) == 1:
                    pairs.append((a, b, quotients.pop()))
        return [pair for pair in pairs if len(str(pair[2])) < LONGEST]

    # --- holds ------------------------------------------------------------------------------------------------------

    def hold(self, kind: str) -> None:
        """Tie a node to ground; a clamp often on a member of a planetary set or differential, or on an inertia."""
        if kind != "lock":
            self.link(kind, self.node(), GROUND)
            return
        members = [n for part in self.parts if part.kind in MEMBERS for n in part.ports.values() if n != GROUND]
        clamped = self.chance.choice(members if members and self.sometimes(0.6) else self.nodes)
        self.add("lock", node=clamped)
        if self.sometimes(0.5):
            self.add("inertia", node=clamped, inertia=self.J)

    def clamp_twice(self) -> None:
        """A clamp on what one holds already."""
        motion = self.motion()
        if held := [node for node in self.nodes if not motion[node]]:
            self.add("lock", node=self.chance.choice(held))

    # --- what can move ----------------------------------------------------------------------------------------------

    def motion(self, *, clamps: bool = True) -> dict[str, dict[str, Fraction]]:
        """Every node as a combination of free ones."""
        rows = [
            without_ground(c.row) for part in self.parts if clamps or not _clamps(part) for c in conditions_of(part)
        ]
        return null_space(rows, self.nodes)


def _clamps(part: Part) -> bool:
    return part.kind == "lock" or (part.kind == "rigid_coupling" and GROUND in part.ports.values())
