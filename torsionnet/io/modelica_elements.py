"""Modelica components of gears, sets and shafts, which Modelica.Mechanics.Rotational has counterparts of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from torsionnet.base.entries.spec import not_none
from torsionnet.io.modelica_net import Net
from torsionnet.io.modelica_parts import declared, port, write_parts
from torsionnet.io.modelica_syntax import ModelicaExpressions, factor
from torsionnet.model.elements import Differential, Element, Gear, Law, Planetary, Shaft

Writer = Callable[[Any, Net, ModelicaExpressions], None]


def _compliant(element: Any, net: Net, words: ModelicaExpressions, entrance: str) -> str:
    """Connection point behind the compliance of a mesh at its first port; the port itself for a rigid mesh."""
    if element.stiffness is None:
        return entrance
    stiffness = words.expression(element.stiffness)
    values = f"c={stiffness}, d={words.damping(element.damping, element.stiffness)}"
    name = declared(element, net, "SpringDamper", values, "_mesh")
    net.points.join(entrance, f"{name}.flange_a")
    return f"{name}.flange_b"


def _gear(element: Gear, net: Net, words: ModelicaExpressions) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(not_none(element.ratio))
    support = ", useSupport=true" if element.housing else ""
    name = declared(element, net, "IdealGear", f"ratio={ratio}{support}")
    net.points.join(_compliant(element, net, words, port(element, "first")), f"{name}.flange_a")
    net.points.join(port(element, "second"), f"{name}.flange_b")
    if element.housing:
        net.points.join(port(element, "housing"), f"{name}.support")


def _quotient(teeth: Any) -> str:
    return f"{int(teeth[1])}/{factor(str(int(teeth[0])))}"


def _planetary(element: Planetary, net: Net, words: ModelicaExpressions) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(not_none(element.ratio))
    name = declared(element, net, "IdealPlanetary", f"ratio={ratio}")
    net.points.join(_compliant(element, net, words, port(element, "sun")), f"{name}.sun")
    for side in ("ring", "carrier"):
        net.points.join(port(element, side), f"{name}.{side}")
    if words.values(element.planet_inertia):
        # A planet rolls on the sun: against the carrier it turns by -2/(z - 1) of what the sun does.
        roll = declared(element, net, "IdealGear", f"ratio=-({ratio} - 1)/2, useSupport=true", "_planet_mesh")
        total = f"{element.planets}*{factor(words.expression(element.planet_inertia))}"
        net.points.join(port(element, "sun"), f"{roll}.flange_a")
        net.points.join(port(element, "carrier"), f"{roll}.support")
        net.points.join(f"{roll}.flange_b", f"{declared(element, net, 'Inertia', f'J={total}', '_planets')}.flange_a")
    if words.values(element.planet_mass) and words.values(element.orbit_radius):
        mass, radius = (factor(words.expression(value)) for value in (element.planet_mass, element.orbit_radius))
        orbit = declared(element, net, "Inertia", f"J={element.planets}*{mass}*{radius}^2", "_orbit")
        net.points.join(port(element, "carrier"), f"{orbit}.flange_a")


def _differential(element: Differential, net: Net, words: ModelicaExpressions) -> None:
    del words
    sides = {"cage": "carrier", "left": "sun", "right": "ring"}
    if element.locked:
        net.points.join(*(port(element, side) for side in sides))
        return
    name = declared(element, net, "IdealPlanetary", "ratio=1")
    for ours, theirs in sides.items():
        net.points.join(port(element, ours), f"{name}.{theirs}")


def _shaft(element: Shaft, net: Net, words: ModelicaExpressions) -> None:
    n = element.segments
    area = (
        f"Modelica.Constants.pi*({_power(words, element.outer_diameter)} - {_power(words, element.inner_diameter)})/32"
    )
    length, modulus, density = (
        factor(words.expression(value)) for value in (element.length, element.shear_modulus, element.density)
    )
    stiffness, inertia = f"{n}*{modulus}*{area}/{length}", f"{density}*{area}*{length}/{n}"
    laws = (part for part in element.parts(words.values) if isinstance(part, Law))
    damping = next(float(law.damping) for law in laws if law.is_elastic)
    points = [port(element, "first"), *(f"node:{node}" for node in element.internal_nodes), port(element, "second")]
    for index in range(n):
        suffix = f"_{index + 1}" if n > 1 else ""
        values = f"c={stiffness}, d={damping!r}" if damping else f"c={stiffness}"
        name = declared(element, net, "SpringDamper" if damping else "Spring", values, suffix)
        net.points.join(points[index], f"{name}.flange_a")
        net.points.join(points[index + 1], f"{name}.flange_b")
        if element.inertia != "none":
            _segment_inertia(element, net, inertia, points[index : index + 2], suffix)


def _power(words: ModelicaExpressions, value: Any) -> str:
    return f"{factor(words.expression(value))}^4"


def _segment_inertia(element: Shaft, net: Net, inertia: str, ends: list[str], suffix: str) -> None:
    """Write the inertia of a shaft segment on its ends, and of a consistent one two thirds on the mean angle."""
    share = 6 if element.inertia == "consistent" else 2
    for end, side in zip(ends, "ab", strict=True):
        lump = declared(element, net, "Inertia", f"J={inertia}/{share}", f"{suffix}_inertia_{side}")
        net.points.join(end, f"{lump}.flange_a")
    if element.inertia == "consistent":
        mean = declared(element, net, "IdealPlanetary", "ratio=1", f"{suffix}_mean")
        middle = declared(element, net, "Inertia", f"J=2*{inertia}/3", f"{suffix}_inertia_mean")
        net.points.join(ends[0], f"{mean}.sun")
        net.points.join(ends[1], f"{mean}.ring")
        net.points.join(f"{mean}.carrier", f"{middle}.flange_a")


_WRITERS: dict[type[Element], Writer] = {
    Gear: _gear,
    Planetary: _planetary,
    Differential: _differential,
    Shaft: _shaft,
}


def write_element(element: Element, net: Net, words: ModelicaExpressions) -> None:
    """Declare and connect the Modelica components of an element."""
    # The nicer components take their values from the entries, which may be quoted at another shaft.
    write = write_parts if element.other_laws or element.has_motion_laws else _WRITERS.get(type(element), write_parts)
    write(element, net, words)
