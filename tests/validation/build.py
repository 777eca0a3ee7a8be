"""Validation cases as drivetrains, each built through the public API as a user would."""

import json
import math
from pathlib import Path

import torsionnet as tn

CASES = Path(__file__).parent / "cases"
STEEL_PIPE = {"outer_diameter": 0.78, "inner_diameter": 0.65, "shear_modulus": 75e9, "density": 8000}


def case_names(prefix=""):
    return sorted(path.stem for path in CASES.glob(f"{prefix}*.json"))


def read_case(name):
    return json.loads((CASES / f"{name}.json").read_text(encoding="utf-8"))


def build(case, extra=()):
    """The drivetrain of a case, with further elements if wanted."""
    elements = [*_nodes(case), *_springs(case), *_gears(case), *_planetary(case), *extra]
    elements += [tn.Lock(f"lock_{node}", node=node) for node in case["grounded"]]
    return tn.Drivetrain(case["name"], elements, source=case["source"])


def spring_name(spring):
    return f"k_{spring['from']}_{spring['to']}"


def damper_matrix(nodes, matrix):
    """Dampers that make up a symmetric matrix: off-diagonals between nodes, row sums to ground."""
    count = range(len(nodes))
    pairs = [(f"c_{nodes[i]}_{nodes[j]}", (nodes[i], nodes[j]), -matrix[i][j]) for i in count for j in count if i < j]
    ground = [(f"c_{nodes[i]}", (nodes[i], "ground"), sum(matrix[i])) for i in count]
    return [tn.Damper(name, nodes=ends, damping=value) for name, ends, value in pairs + ground]


def drill_string_from_geometry(case):
    """The drill string as one shaft of five segments with consistent inertia."""
    ends = [node for node in case["nodes"] if node["inertia"]]
    first, last = (node["name"] for node in ends)
    pipe = tn.Shaft("pipe", nodes=(first, last), length=800, segments=5, **STEEL_PIPE)
    return tn.Drivetrain(case["name"], [*_nodes(case | {"nodes": ends}), pipe], source=case["source"])


def _nodes(case):
    for node in case["nodes"]:
        name = node["name"]
        if node["inertia"]:
            yield tn.Inertia(f"J_{name}", node=name, inertia=node["inertia"])
        if node["damping_to_ground"]:
            yield tn.Damper(f"c_{name}", nodes=(name, "ground"), damping=node["damping_to_ground"])


def _springs(case):
    for spring in case["springs"]:
        name, ends, stiffness = spring_name(spring), (spring["from"], spring["to"]), spring["stiffness"]
        if "inertia" in spring:
            yield _bar(name, ends, stiffness, spring["inertia"])
        else:
            yield tn.Spring(name, nodes=ends, stiffness=stiffness, damping=spring["damping"])


def _bar(name, ends, stiffness, inertia):
    """A uniform bar of given stiffness and inertia: any diameter and length serve with the material to match."""
    area_moment = math.pi / 32
    material = {"shear_modulus": stiffness / area_moment, "density": inertia / area_moment}
    return tn.Shaft(name, nodes=ends, outer_diameter=1, length=1, **material)


def _gears(case):
    for gear in case["gears"]:
        ends = (gear["from"], gear["to"])
        mesh = {key: gear[key] for key in ("stiffness", "damping") if key in gear}
        yield tn.Gear(f"gear_{'_'.join(ends)}", nodes=ends, ratio=gear["ratio"], **mesh)


def _planetary(case):
    """Every mesh a gear of its own, with the carrier as housing."""
    if "planetary" not in case:
        return
    p = case["planetary"]
    ring_radius = p["r_sun"] + 2 * p["r_planet"]
    sun_mesh, ring_mesh = (p["k_sun_planet"] * p["r_sun"] ** 2, p["k_ring_planet"] * p["r_planet"] ** 2)
    for planet in p["planets"]:
        sun, ring = (p["sun"], planet), (planet, p["ring"])
        outer, inner = -p["r_planet"] / p["r_sun"], ring_radius / p["r_planet"]
        yield tn.Gear(f"sun_{planet}", nodes=sun, ratio=outer, housing=p["carrier"], stiffness=sun_mesh)
        yield tn.Gear(f"ring_{planet}", nodes=ring, ratio=inner, housing=p["carrier"], stiffness=ring_mesh)
