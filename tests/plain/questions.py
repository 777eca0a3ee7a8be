"""What else is asked of a plant: symbols, motion over time, orders, values quoted elsewhere, alternatives, states at rest."""

from __future__ import annotations

import cmath
import copy
import json
import math
import random
from collections.abc import Iterator
from typing import Any

import networkx as nx
import numpy as np
from flint import acb, arb, ctx

import torsionnet as tn
from plain.equations import Dense
from plain.trains import Plant

Answer = tuple[str, complex, complex, float]
"""What it is, what was found, what is exact, and to how much."""
MOST_NODES = 5
MOST_TERMS = 400
TURNING = ("spring", "hysteretic_spring", "crank_throw", "gear", "belt", "chain_drive", "dual_mass_flywheel")
"""Through these mean speeds have a ratio."""


def _s(f: float) -> acb:
    return acb(0, 2 * arb.pi() * arb(f))


def number(value: acb) -> complex:
    return complex(float(value.real.mid()), float(value.imag.mid()))


def symbols(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """Transfer functions of small plants in symbols, at numbers."""
    if len(Dense(drawn).nodes) > MOST_NODES:
        return
    output, source = chance.choice(list(drawn.outputs)), chance.choice(list(drawn.inputs))
    f = [1.7, 23.0, 170.0]
    found = rig.symbolic().transfer_function(output, source).evaluate(f).values.ravel()
    for one, value in zip(f, found, strict=True):
        yield "symbols", value, number(_entry(drawn, _s(one), output, source)), 1e-9


def _entry(drawn: Plant, s: acb, output: str, source: str, changed: Any = None) -> acb:
    row, column = list(drawn.outputs).index(output), list(drawn.inputs).index(source)
    return Dense(drawn, changed).response(s)[row][column]


def rest(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """The response at 0 Hz against the limit, where it has one."""
    if not drawn.is_rational:
        return
    output, source = chance.choice(list(drawn.outputs)), chance.choice(list(drawn.inputs))
    try:
        low = [_entry(drawn, acb(0, arb(f"1e-{size}")), output, source) for size in (40, 42)]
    except ZeroDivisionError:
        return  # what moves without end there leaves no digits
    largest = max(float(abs(one).mid()) for one in low)
    if largest > 1e20 or abs(number(low[0]) - number(low[1])) > 1e-12 * largest:
        return
    found = rig.frequency_response(output, source, [0.0]).values.item()
    yield "at rest", found, number(low[1]) if largest > 1e-30 else 0.0, 1e-9


def motion(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """A torque that rises evenly, against the inverse of the Laplace transform by Talbot's contour."""
    if not drawn.is_rational or any(one.kind == "controller" for one in drawn.components.values()):
        return
    output = chance.choice(list(drawn.outputs))
    source = chance.choice([name for name, (quantity, _) in drawn.inputs.items() if quantity == "torque"])
    rate, count = 20000.0, 60
    largest = max(float(np.abs(rig.modes().eigenvalues).max()), 1.0)
    terms = 60 + 4 * math.ceil(largest * count / rate)
    if terms > MOST_TERMS:
        return
    recording = rig.simulate([*drawn.outputs], {source: np.arange(count) / rate}, rate)
    values = recording[output].values
    # What is far from the torque hardly moves at first: it is as exact as the largest motion's last digits.
    noise = 1e-4 * max(float(np.abs(recording[one].values).max()) for one in drawn.outputs)
    size = max(float(np.abs(values).max()), noise) or 1.0
    for place in (20, 59):
        t = place / rate
        exact = _talbot(lambda s: _entry(drawn, s, output, source) / s**2, t, terms)
        yield "motion", 1 + (values[place] - exact) / size, 1.0, 1e-9


def _talbot(transform: Any, t: float, terms: int) -> float:
    before, ctx.prec = ctx.prec, 200 + 3 * terms
    total = acb(0)
    for k in range(terms):
        theta = arb.pi() * (2 * k + 1 - terms) / terms + arb("1e-30")
        cot = theta.cos() / theta.sin()
        at = acb(theta * cot, theta) * terms / (5 * t)
        slope = acb(cot - theta / theta.sin() ** 2, 1) * terms / (5 * t)
        total += (at * t).exp() * transform(at) * slope
    ctx.prec = before
    return float((total / (acb(0, 1) * terms)).real.mid())


def orders(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """Orders of a torque between two nodes; pendulums follow the speed."""
    del rig
    torques = [of for quantity, of in drawn.inputs.values() if quantity == "torque"]
    if len(torques) < len(drawn.inputs):
        return
    of, data, ratios = torques[0], copy.deepcopy(drawn.data), _ratios(drawn)
    if of[0] not in ratios:
        return
    following = [
        one["speed"] for one in data["elements"].values()
        if one["type"] == "pendulum_absorber" and isinstance(one["speed"], str)
    ]  # fmt: skip
    for name in following:
        data["parameters"][name] = {"by": "speed", "of": "n0"}
    amplitude, phase, rpm = 120.0, 35.0, [400.0, 777.0, 1500.0]
    acting = {
        "type": "harmonic",
        "node": of[0],
        "speed_of": "n0",
        "orders": {"1.5": {"amplitude": amplitude, "phase": f"{phase} deg"}},
    }
    data["excitations"] = {"x": acting | ({"reaction": of[1]} if len(of) == 2 else {})}
    data["speeds"] = {"of": "n0", "list": [f"{one} rpm" for one in rpm], "rated": "777 rpm"}
    run = tn.loads(json.dumps(data)).order_response(list(drawn.outputs))
    # A torque is counted in the sense in which its node turns.
    phasor = math.copysign(amplitude, ratios[of[0]]) * cmath.exp(1j * math.radians(phase))
    for place, one in enumerate(rpm):
        omega = arb(one) * arb.pi() / 30
        exact = Dense(drawn, dict.fromkeys(following, omega)).response(acb(0, arb("1.5") * omega))
        for row in range(len(drawn.outputs)):
            yield "order", run.values[place, 0, row], number(exact[row][0]) * phasor, 1e-9


def quoted(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """Springs and inertias by what they are worth at the first node."""
    del rig
    data, ratios = copy.deepcopy(drawn.data), _ratios(drawn)
    changed = 0
    for entries in data["elements"].values():
        own = entries.get("node") or entries.get("nodes", [""])[0]
        if entries["type"] not in ("spring", "inertia") or own not in ratios or own == "n0":
            continue
        entries["referred_to"] = "n0"
        for entry in ("stiffness", "damping", "inertia"):
            if entry in entries:
                given = entries[entry]
                value = drawn.parameters[given] if isinstance(given, str) else given
                entries[entry] = value * ratios[own] ** 2
        changed += 1
    if changed:
        model = tn.loads(json.dumps(data))
        output, source = chance.choice(list(drawn.outputs)), chance.choice(list(drawn.inputs))
        f = [2.0, 41.0]
        found = model.frequency_response(output, source, f).values.ravel()
        for one, value in zip(f, found, strict=True):
            yield "quoted", value, number(_entry(drawn, _s(one), output, source)), 1e-9
        for node, ratio in ratios.items():
            referred = model.frequency_response(f"angle({node}) referred to n0", source, [3.0]).values.item()
            own = model.frequency_response(f"angle({node})", source, [3.0]).values.item()
            yield "referred angle", referred, own / ratio, 1e-9


def _ratios(drawn: Plant) -> dict[str, float]:
    """Mean speed of nodes over that of the first, through springs and gears."""

    def worth(one: Any) -> float:
        return drawn.parameters[one] if isinstance(one, str) else one

    rows = []
    for one in drawn.components.values():
        if one.kind in TURNING:
            equations = one.equations(lambda given: acb(worth(given)))
            turning = [*equations.held, *(law.driven for law in equations.laws if len(law.driven) == 2)]
            rows += [[(node, number(acb(x)).real) for node, x in row.items()] for row in turning]
    found, before = {"n0": 1.0}, 0
    while len(found) > before:
        before = len(found)
        for (a, x), (b, y) in rows:
            if a in found:
                found.setdefault(b, -found[a] * x / y)
            elif b in found:
                found[a] = -found[b] * y / x
    return found if nx.is_forest(_joined(drawn)) else {}  # a loop may hold shafts of different speeds


def _joined(drawn: Plant) -> nx.Graph:
    """Components and the nodes that they join."""
    graph = nx.Graph([("", "n0")])
    for name, one in drawn.components.items():
        if one.kind != "controller":
            equations = one.equations(lambda given: acb(drawn.parameters[given] if isinstance(given, str) else given))
            ends = {node for row in (*equations.held, *(law.driven for law in equations.laws)) for node in row}
            graph.add_edges_from((f"component {name}", node) for node in ends - {"ground"})
    return graph


def alternatives(drawn: Plant, rig: tn.Drivetrain, chance: random.Random) -> Iterator[Answer]:
    """Entries of elements that an alternative puts right."""
    del rig
    data, right = copy.deepcopy(drawn.data), {}
    for name, entries in data["elements"].items():
        for entry, value in entries.items():
            if isinstance(value, float) and entry in ("stiffness", "damping", "inertia", "mass", "ring_inertia"):
                right[f"{name}.{entry}"], entries[entry] = value, value * 1.5
            if entry == "engaged":
                right[f"{name}.{entry}"], entries[entry] = value, "I"
    if not right:
        return
    data["configurations"] = {"how": {"wrong": {}, "right": right}}
    model = tn.loads(json.dumps(data)).configured("right")
    output, source = chance.choice(list(drawn.outputs)), chance.choice(list(drawn.inputs))
    for one in (2.0, 41.0):
        found = model.frequency_response(output, source, [one]).values.item()
        yield "alternative", found, number(_entry(drawn, _s(one), output, source)), 1e-9


QUESTIONS = (symbols, rest, motion, orders, quoted, alternatives)
