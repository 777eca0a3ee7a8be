"""In which roles the elements of a model stand, found from the finished model."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from oracle.description import GROUND, MEMBERS, SINGLE, Measure, Part
from oracle.solution import Mechanics

EVERY = frozenset(
    f"{kind}: {role}"
    for kind, text in {
        "inertia": "any, clamped, cannot move, angle imposed, follows others rigidly, of value zero",
        "spring": "any, damped, damping by a measure, of value zero, to ground, clamped, cannot move, angle imposed, "
        "follows others rigidly, massless node, in a loop",
        "damper": "any, of value zero, to ground, clamped, cannot move, angle imposed, follows others rigidly, "
        "massless node, in a loop",
        "hysteretic_spring": "any, damped, damping by a measure, loss by a measure, to ground, clamped, angle imposed, in a loop, "
        "follows others rigidly, massless node",
        "tabulated_spring": "any, to ground, clamped, angle imposed, in a loop, follows others rigidly, massless node",
        "gear": "any, rigid, compliant, teeth, ratio, same sense, opposite senses, rigid with housing, "
        "compliant with housing, damped, damping by a measure, clamped, cannot move, angle imposed, massless node, "
        "to ground, housing on ground, in a loop, in a rigid loop, follows others rigidly",
        "planetary": "any, rigid, compliant, teeth, ratio, planet inertia, planet mass, damped, damping by a measure, sun on ground, "
        "ring on ground, carrier on ground, sun clamped, ring clamped, carrier clamped, cannot move, angle imposed, "
        "massless node, in a loop, in a rigid loop, follows others rigidly",
        "differential": "any, open, locked, cage on ground, left on ground, right on ground, cage clamped, "
        "left clamped, right clamped, cannot move, angle imposed, massless node, in a loop, in a rigid loop",
        "rigid_coupling": "any, to ground, clamped, cannot move, angle imposed, in a loop, in a rigid loop",
        "lock": "any, clamped, in a rigid loop",
        "shaft": "any, inertia consistent, inertia lumped, inertia none, several segments, one segment, hollow, solid, "
        "damped, damping by a measure, to ground, clamped, cannot move, angle imposed, in a loop, massless node, "
        "follows others rigidly",
        "model": "2 to 4 nodes, 5 to 14 nodes, 15 nodes or more, 40 nodes or more, several imposed angles, "
        "several torques, nothing free, turns freely, held, damped, undamped, massless motion, J over nine decades, "
        "k over nine decades, c over nine decades",
    }.items()
    for role in text.split(", ")
)
"""What a comparison of some hundred models must have drawn."""


def roles(mechanics: Mechanics) -> set[str]:
    """Words for every element in every role, and for the model as a whole."""
    model = mechanics.model
    found = {f"{part.kind}: {role}" for part in model.parts for role in (*variants(part), *places(part, mechanics))}
    return found | set(whole(mechanics))


def variants(part: Part) -> Iterator[str]:
    """What the element is by itself."""
    v = part.values
    yield "any"
    if part.kind in ("gear", "planetary"):
        yield "rigid" if part.is_rigid else "compliant"
        yield "teeth" if "teeth" in v else "ratio"
    if part.kind == "gear":
        yield "opposite senses" if part.ratio < 0 else "same sense"
        if part.ports.get("housing"):
            yield "rigid with housing" if part.is_rigid else "compliant with housing"
    if part.kind == "planetary":
        for entry in ("planet_inertia", "planet_mass"):
            if v.get(entry):
                yield entry.replace("_", " ")
    if part.kind == "differential":
        yield "locked" if v.get("locked") else "open"
    if part.kind == "shaft":
        yield f"inertia {v.get('inertia', 'consistent')}"
        yield "several segments" if part.internal else "one segment"
        yield "hollow" if "inner_diameter" in v else "solid"
    if "damping" in v and part.kind != "damper":
        yield "damping by a measure" if isinstance(v["damping"], Measure) else "damped"
    if isinstance(v.get("loss_factor"), Measure):
        yield "loss by a measure"
    if any(v.get(entry) == 0 for entry in ("inertia", "stiffness", "damping") if isinstance(v.get(entry), Fraction)):
        yield "of value zero"


def places(part: Part, mechanics: Mechanics) -> Iterator[str]:
    """Where it stands."""
    ports, parts, imposed = part.ports, mechanics.model.parts, set(mechanics.model.imposed.values())
    locked = {other.ports["node"] for other in parts if other.kind == "lock" and other is not part}
    heavy = {other.ports["node"] for other in parts if other.kind == "inertia" and other is not part}
    for port, node in ports.items():
        if node == GROUND:
            yield f"{port} on ground" if part.kind in MEMBERS or port == "housing" else "to ground"
        elif node in locked:
            yield f"{port} clamped" if part.kind in MEMBERS else "clamped"
        elif not mechanics.motion[node]:
            yield "cannot move"
        if node in imposed:
            yield "angle imposed"
        elif node != GROUND and node in mechanics.eliminated and node not in locked:
            yield "follows others rigidly"
        if node != GROUND and node not in heavy and part.kind not in SINGLE:
            yield "massless node"
    if part.kind not in SINGLE and part.name in mechanics.in_loops:
        yield "in a loop"
    if part.is_rigid and any(label.split("#")[0] == part.name for label in mechanics.shared):
        yield "in a rigid loop"


def whole(mechanics: Mechanics) -> Iterator[str]:
    """What the model is."""
    model, size = mechanics.model, len(mechanics.nodes)
    yield "model: 2 to 4 nodes" if size < 5 else "model: 5 to 14 nodes" if size < 15 else "model: 15 nodes or more"
    if size >= 40:
        yield "model: 40 nodes or more"
    if len(model.imposed) > 1:
        yield "model: several imposed angles"
    if len(model.inputs) - len(model.imposed) > 1:
        yield "model: several torques"
    if not mechanics.freedom:
        yield "model: nothing free"
    else:
        yield "model: turns freely" if mechanics.rank_of("k") < mechanics.freedom else "model: held"
        yield "model: damped" if mechanics.rank_of("c") else "model: undamped"
        if mechanics.rank_of("J") < mechanics.freedom:
            yield "model: massless motion"
    for letter in "Jkc":
        known = [v for law in mechanics.laws if isinstance(v := getattr(law, letter), Fraction) and v]
        if known and max(known) >= 10**9 * min(known):
            yield f"model: {letter} over nine decades"
