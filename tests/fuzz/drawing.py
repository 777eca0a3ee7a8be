"""Models and expressions put together at random, sound or not."""

from __future__ import annotations

from fuzz.mutating import NUMBERS, Chance

NODES = ("a", "b", "c", "d", "e", "ground")
PAIRS = {
    "spring": ("stiffness: {}", "stiffness: {}, damping: {}", "stiffness: {}, damping: {{zeta: {}, at: 8 Hz}}"),
    "damper": ("damping: {}",),
    "hysteretic_spring": ("stiffness: {}, loss_factor: {}",),
    "tabulated_spring": ("table: [[1, {}, {}], [20, {}, {}], [300, 1e3, 10]]",),
    "gear": ("ratio: {}", "teeth: [17, 61]", "ratio: {}, stiffness: {}, damping: {}"),
    "rigid_coupling": ("",),
    "shaft": ("outer_diameter: {}, length: {}", "outer_diameter: 50 mm, length: {}, segments: 10"),
}
OPERATORS = (" + ", "*", "/", " - ", "**")
ATOMS = ("k", "J", "tau", "2", "0.5", "1e3", "pi", "omega", "x", "3 kN*m/rad", "17/61", "")


def number(chance: Chance) -> str:
    """Mostly one that an engineer would write."""
    if chance.random() < 0.04:
        return chance.choice((*NUMBERS, "k", "2*k", "J", "tau", "k/tau**2", "p3"))
    return f"{10 ** chance.uniform(-3, 6):.3g}"


def expression(chance: Chance, depth: int = 4) -> str:
    """A formula, whole or with something missing."""
    kind = chance.random()
    if depth == 0 or kind < 0.3:
        return chance.choice((*ATOMS, *NUMBERS, "1" * chance.randint(1, 60)))
    if kind < 0.4:
        return f"sqrt({expression(chance, depth - 1)})"
    if kind < 0.5:
        return f"-{expression(chance, depth - 1)}"
    both = chance.choice(OPERATORS).join(expression(chance, depth - 1) for _ in range(2))
    return f"({both})" if chance.random() < 0.6 else both


def model(chance: Chance) -> str:
    """A model file of some elements between a few nodes."""
    parameters = ["k: 1 kN*m/rad", "J: 0.1 kg*m^2", "tau: 4.1"]
    chain = chance.choice([0, 0, 0, 4, 12])
    parameters += [f"p{at}: {f'p{at - 1}*p{at - 1}' if at else expression(chance, 2)}" for at in range(chain)]
    elements = [f"  J_{node}: {{type: inertia, node: {node}, inertia: {number(chance)}}}" for node in NODES[:2]]
    for at in range(chance.randint(1, 6)):
        kind = chance.choice(sorted(PAIRS))
        # Each hangs on a node that is there, most of them a new one.
        nodes, form = (
            [chance.choice(NODES[: at + 1]), chance.choice([NODES[min(at + 1, 5)]] * 3 + [*NODES])],
            chance.choice(PAIRS[kind]),
        )
        values = form.format(*(number(chance) for _ in range(form.count("{}"))))
        elements.append(f"  e{at}: {{type: {kind}, nodes: [{', '.join(nodes)}]{', ' if values else ''}{values}}}")
    more = chance.choice(
        [
            "",
            "",
            f"operating_point: {{speed: {{a: {number(chance)} rpm}}}}\n",
            f"configurations: {{gear: {{I: {{tau: {number(chance)}}}, II: {{off: [e0]}}}}}}\n",
        ]
    )
    return (
        "torsionnet: 1\nname: drawn\nparameters:\n" + "".join(f"  {line}\n" for line in parameters)
        + "elements:\n" + "\n".join(elements) + "\ninputs: {T: {torque: a}}\nsensors: {phi: {angle: b}, M: {torque: e0}}\n" + more
    )  # fmt: skip
