"""Components joined to a plant: a tree with loops and branches, parts with copies, inputs and sensors."""

from __future__ import annotations

import json
import random
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import torsionnet as tn
from plain import control, dampers, gears, machines
from plain.component import Component, Draw, Equations, inertia

THROUGH = (*gears.THROUGH, *machines.THROUGH, *dampers.THROUGH)
AT_A_NODE = (*machines.AT_A_NODE, *dampers.AT_A_NODE)


def body(d: Draw, name: str, a: str) -> Component:
    J = d.J
    return Component({"type": "inertia", "node": a, "inertia": J}, lambda v: Equations([inertia(a, v(J))]), a)


@dataclass
class Network:
    """Components by name and nodes, with parameters of their own."""

    draw: Draw
    nodes: list[str] = field(default_factory=lambda: ["n0"])
    parts: dict[str, Component] = field(default_factory=dict)

    def fresh(self) -> str:
        self.nodes.append(f"n{len(self.nodes)}")
        self.put(body, self.nodes[-1])
        return self.nodes[-1]

    def put(self, kind: Any, *nodes: str) -> None:
        name = f"e{len(self.parts)}"
        self.parts[name] = kind(self.draw, name, *nodes)

    def node(self) -> str:
        return self.draw.chance.choice(self.nodes)

    def grow(self, steps: int, branches: int) -> None:
        self.put(body, self.nodes[0])
        for _ in range(steps):
            a = self.node()
            if self.draw.sometimes(0.08):
                self.put(gears.belt, a, self.fresh(), self.fresh())
            elif self.draw.sometimes(0.08):
                self.put(gears.final_drive, a, self.fresh(), self.fresh())
            else:
                self.put(self.draw.chance.choice(THROUGH), a, self.fresh())
        if len(self.nodes) > 3 and self.draw.sometimes(0.4):
            self.put(gears.plain_spring, *self.draw.chance.sample(self.nodes, 2))
        for _ in range(branches):
            self.put(self.draw.chance.choice(AT_A_NODE), self.node())
        if len(self.nodes) > 2 and self.draw.sometimes(0.3):
            self.put(control.controller, *self.draw.chance.sample(self.nodes, 3))

    def data(self) -> dict[str, Any]:
        return {
            "parameters": dict(self.draw.parameters),
            "elements": {name: dict(part.entries) for name, part in self.parts.items()},
        }


@dataclass
class Plant:
    """The data of a model file, and all its components with the names that they have in the whole."""

    data: dict[str, Any]
    components: dict[str, Component]
    parameters: dict[str, float]
    inputs: Mapping[str, tuple[str, tuple[str, ...]]]
    outputs: Mapping[str, tuple[str, tuple[str, ...]]]

    @property
    def text(self) -> str:
        return json.dumps(self.data, indent=1)  # JSON is YAML

    def model(self) -> tn.Drivetrain:
        return tn.loads(self.text)

    @property
    def is_rational(self) -> bool:
        return all(one.is_rational for one in self.components.values())


def plant(seed: str) -> Plant:
    chance = random.Random(seed)
    whole = Network(Draw(chance))
    whole.grow(chance.randint(1, 5), chance.randint(0, 3))
    data = {"torsionnet": 1, "name": "drawn", **whole.data()}
    components, parameters = dict(whole.parts), dict(whole.draw.parameters)
    if chance.random() < 0.5:
        _use(chance, whole, data, components, parameters)
    inputs, outputs = _channels(chance, whole.nodes, components)
    data["inputs"] = {name: {quantity: _nodes(of)} for name, (quantity, of) in inputs.items()}
    data["sensors"] = {name: {quantity: _nodes(of)} for name, (quantity, of) in outputs.items()}
    return Plant(data, components, parameters, inputs, outputs)


def _nodes(of: tuple[str, ...]) -> Any:
    return of[0] if len(of) == 1 else list(of)


def _use(chance: random.Random, whole: Network, data: dict, components: dict, parameters: dict) -> None:
    """A part, perhaps inside another one, one copy or several, branching off or in a chain."""
    inner = Network(Draw(chance), ["front"])
    inner.grow(chance.randint(1, 2), chance.randint(0, 1))
    rear = inner.nodes[-1]
    ports = ["front", rear] if rear != "front" else ["front"]
    data["parts"] = {"one": {"ports": ports, **inner.data()}}
    content, own, used, copies = dict(inner.parts), dict(inner.draw.parameters), "one", chance.choice((1, 2, 3))
    if chance.random() < 0.4:
        shell = Network(Draw(chance), ["front"])
        shell.put(body, "front")
        data["parts"]["two"] = {
            "ports": ["front"], **shell.data(), "use": {"inner": {"part": "one", "at": {"front": "front", **dict.fromkeys(ports[1:], "tip")}}},
        }  # fmt: skip
        below = {
            name: one.renamed(dict(zip(ports, ("front", "tip"), strict=False)), "inner.")
            for name, one in content.items()
        }
        content = {f"inner.{name}": one for name, one in below.items()} | dict(shell.parts)
        own = {f"inner.{name}": one for name, one in own.items()} | dict(shell.draw.parameters)
        ports, used = ["front"], "two"
    start = whole.node()
    changed = [name for name in own if "." not in name and chance.random() < 0.4]
    factors = {name: [1 + chance.randint(0, 50) / 100 for _ in range(copies)] for name in changed}
    values = {name: [own[name] * factor for factor in factors[name]] for name in changed}
    names = [f"u{i + 1}" for i in range(copies)]
    chained = len(ports) == 2 and chance.random() < 0.6
    fronts = [start] * copies if not chained else [start, *(f"{name}.front" for name in names[1:])]
    last = "end"
    rears = [*fronts[1:], last] if chained else [f"{last}{i}" for i in range(copies)]
    at = {"front": start} | ({ports[1]: last if chained else rears} if len(ports) == 2 else {})
    use = {"part": used, "repeat": copies, "at": at, "parameters": values}
    data["use"] = {"u": use | ({"chain": ports} if chained else {})}
    for i, name in enumerate(names):
        joined = dict(zip(ports, (fronts[i], rears[i]), strict=False))
        components |= {f"{name}.{key}": one.renamed(joined, f"{name}.") for key, one in content.items()}
        parameters |= {f"{name}.{key}": values[key][i] if key in values else one for key, one in own.items()}
    whole.nodes += [last] if chained else rears if len(ports) == 2 else []


def _channels(chance: random.Random, nodes: list[str], components: Mapping[str, Component]) -> tuple[dict, dict]:
    def pair() -> tuple[str, ...]:
        return tuple(chance.sample(nodes, 2)) if len(nodes) > 1 and chance.random() < 0.5 else (chance.choice(nodes),)

    inputs = {f"T{i}": ("torque", pair()) for i in range(2)}
    if chance.random() < 0.25:
        phi = pair()
        if len(phi) == 2 or phi[0] not in {node for _, of in inputs.values() for node in of}:
            inputs["phi"] = ("angle", phi)
    outputs: dict[str, tuple[str, tuple[str, ...]]] = {
        f"y{i}": (chance.choice(("angle", "velocity", "acceleration")), pair()) for i in range(3)
    }
    names = chance.sample(sorted(components), min(3, len(components)))
    return inputs, outputs | {f"M{i}": ("torque", (name,)) for i, name in enumerate(names)}
