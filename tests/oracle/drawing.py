"""Random models: every element in every role, valid by construction."""

from __future__ import annotations

import random
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from oracle.description import GROUND, Model
from oracle.exact import Span
from oracle.growing import Growing
from oracle.physics import conditions_of
from oracle.solution import Mechanics, without_ground

SIZES = {(2, 4): 20, (3, 9): 55, (5, 14): 15, (10, 25): 8, (26, 60): 2}
"""Ranges of numbers of nodes, and how often each is drawn."""
LARGE = 15
GROWTH = {
    "spring": 20, "damper": 4, "hysteretic_spring": 3, "tabulated_spring": 3, "gear": 10, "compliant_gear": 5,
    "housed_gear": 5, "planetary": 6, "differential": 5, "rigid_coupling": 6, "shaft": 5,
}  # fmt: skip
EPICYCLIC = {"planetary": 4, "differential": 4, "housed_gear": 3, "spring": 6, "damper": 2, "gear": 2}
CLOSING = {
    "spring": 6, "damper": 3, "compliant_gear": 3, "consistent_gear": 4, "rigid_gear": 4, "hysteretic_spring": 1,
    "tabulated_spring": 1, "shaft": 1, "planetary": 2, "differential": 2, "parallel": 2,
}  # fmt: skip
HOLDS = {
    "lock": 8, "spring": 5, "damper": 4, "hysteretic_spring": 1, "tabulated_spring": 1, "shaft": 1, "rigid_coupling": 1,
}  # fmt: skip
CLAMPS = {"lock": 8, "spring": 1, "damper": 1}
FREQUENCY_DEPENDENT = ("hysteretic_spring", "tabulated_spring")


class Draw(Growing):
    """One model from its first node to its inputs."""

    def model(self) -> Model:
        size = self.chance.randint(*self.chance.choices(list(SIZES), list(SIZES.values()))[0])
        self.plain = self.sometimes(0.9 if size > LARGE else 0.5)
        growth, holds = (EPICYCLIC, CLAMPS) if self.sometimes(0.25) else (GROWTH, HOLDS)
        while len(self.nodes) < size:
            self.attempt(self.grow, self.choose(growth))
        heavy = self.chance.choice((0.15, 0.3, 0.6, 0.9, 1.0))
        for node in self.nodes:
            if self.sometimes(heavy):
                self.add("inertia", node=node, inertia=self.J)
        for _ in range(self.chance.choice((0, 0, 1, 2, 3)) if size < LARGE else self.chance.randint(0, size // 4)):
            self.attempt(self.close, self.choose(CLOSING))
        for _ in range(self.chance.choice((0, 1, 1, 2, 3))):
            self.attempt(self.hold, self.choose(holds))
        if self.sometimes(0.05):
            self.clamp_twice()
        if self.sometimes(0.08):
            self.empty()
        self.chance.shuffle(self.parts)
        inputs = self.inputs()
        self.fill(inputs)
        return Model(tuple(self.parts), inputs)

    def choose(self, weights: Mapping[str, int]) -> str:
        """A kind of step; some models have no dampers, some no stiffness that depends on frequency."""
        kinds = [kind for kind in weights if not (self.plain and kind in FREQUENCY_DEPENDENT)]
        if self.lossless and self.sometimes(0.8):
            kinds.remove("damper")
        return self.chance.choices(kinds, [weights[kind] for kind in kinds])[0]

    def attempt(self, step: Any, kind: str) -> None:
        """One step, taken back if rigid parts would then contradict each other or nothing could move."""
        parts, nodes = list(self.parts), list(self.nodes)
        step(kind)
        if not all(self.motion(clamps=False).values()) or not any(self.motion().values()):
            self.parts, self.nodes = parts, nodes

    def inputs(self) -> dict[str, tuple[str, str]]:
        """Torques on nodes that can move, and imposed angles that contradict nothing."""
        span = Span()
        for part in self.parts:
            for condition in conditions_of(part):
                span.add(without_ground(condition.row))
        wanted = min(self.chance.choice((0, 0, 0, 1, 1, 2)), len(self.nodes))
        imposed = [node for node in self.chance.sample(self.nodes, wanted) if span.add({node: Fraction(1)})]
        moving = [node for node in self.nodes if span.reduced({node: Fraction(1)})[0]]
        torques = self.chance.sample(moving, min(self.chance.choice((1, 1, 2, 3)), len(moving)))
        inputs = {f"phi{i}": ("angle", node) for i, node in enumerate(imposed)}
        inputs |= {f"T{i}": ("torque", node) for i, node in enumerate(torques)}
        return {name: inputs[name] for name in self.chance.sample(list(inputs), len(inputs))}

    def fill(self, inputs: Mapping[str, tuple[str, str]]) -> None:
        """Inertias, springs and dampers to ground until every motion is answered."""
        mechanics, span = Mechanics(Model(tuple(self.parts), inputs)), Span()
        for law in mechanics.laws:
            if law.acts("Jck"):
                span.add(mechanics.reduced(law.row))
        for node in self.chance.sample(self.nodes, len(self.nodes)):
            if span.add(mechanics.reduced({node: Fraction(1)})):
                kind = self.chance.choices(("inertia", "spring", "damper"), (7, 2, 0 if self.lossless else 1))[0]
                if kind == "inertia":
                    self.add("inertia", node=node, inertia=self.J)
                else:
                    self.link(kind, node, GROUND)


def draw(seed: str) -> Model:
    """The model of this seed."""
    return Draw(random.Random(seed)).model()
