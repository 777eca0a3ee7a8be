"""Each type of element as components of Modelica.Mechanics.Rotational."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from torsionnet.io.modelica_net import Net
from torsionnet.io.modelica_words import ROTATIONAL, ModelicaWords, factor, quoted
from torsionnet.model.elements import (
    Damper,
    Differential,
    Element,
    Gear,
    HystereticSpring,
    Inertia,
    Law,
    Lock,
    Planetary,
    RigidCoupling,
    Shaft,
    Spring,
    Values,
)

Writer = Callable[[Any, Net, ModelicaWords], None]
COMPONENTS = f"{ROTATIONAL}.Components"


def port(element: Element, name: str) -> str:
    """The point of a port; joined to its node, or to a torque sensor in between."""
    return f"port:{element.name}.{name}"


def _declared(element: Element, net: Net, kind: str, values: str = "", suffix: str = "") -> str:
    comment = quoted(element.description) if element.description and not suffix else ""
    return net.declare(f"{COMPONENTS}.{kind}", element.name + suffix, values, comment)


def _inertia(element: Inertia, net: Net, words: ModelicaWords) -> None:
    name = _declared(element, net, "Inertia", f"J={words.expression(element.inertia)}")
    net.join(port(element, "node"), f"{name}.flange_a")


def _spring(element: Spring | HystereticSpring, net: Net, words: ModelicaWords) -> None:
    stiffness, damping = words.expression(element.stiffness), words.damping(element.damping, element.stiffness)
    if damping == "0":
        name = _declared(element, net, "Spring", f"c={stiffness}")
    else:
        name = _declared(element, net, "SpringDamper", f"c={stiffness}, d={damping}")
    _between(element, net, name)


def _damper(element: Damper, net: Net, words: ModelicaWords) -> None:
    _between(element, net, _declared(element, net, "Damper", f"d={words.expression(element.damping)}"))


def _between(element: Element, net: Net, name: str) -> None:
    net.join(port(element, "first"), f"{name}.flange_a")
    net.join(port(element, "second"), f"{name}.flange_b")


def _coupling(element: RigidCoupling, net: Net, words: ModelicaWords) -> None:
    del words
    net.join(port(element, "first"), port(element, "second"))


def _lock(element: Lock, net: Net, words: ModelicaWords) -> None:
    del words
    net.join(port(element, "node"), f"{_declared(element, net, 'Fixed')}.flange")


def _compliant(element: Any, net: Net, words: ModelicaWords, entrance: str) -> str:
    """The point behind the compliance of a mesh, which sits at its first port; the port itself if it is rigid."""
    if element.stiffness is None:
        return entrance
    stiffness = words.expression(element.stiffness)
    values = f"c={stiffness}, d={words.damping(element.damping, element.stiffness)}"
    name = _declared(element, net, "SpringDamper", values, "_mesh")
    net.join(entrance, f"{name}.flange_a")
    return f"{name}.flange_b"


def _gear(element: Gear, net: Net, words: ModelicaWords) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(element.ratio)
    support = ", useSupport=true" if element.housing else ""
    name = _declared(element, net, "IdealGear", f"ratio={ratio}{support}")
    net.join(_compliant(element, net, words, port(element, "first")), f"{name}.flange_a")
    net.join(port(element, "second"), f"{name}.flange_b")
    if element.housing:
        net.join(port(element, "housing"), f"{name}.support")


def _quotient(teeth: Any) -> str:
    return f"{int(teeth[1])}/{factor(str(int(teeth[0])))}"


def _planetary(element: Planetary, net: Net, words: ModelicaWords) -> None:
    ratio = _quotient(element.teeth) if element.teeth else words.expression(element.ratio)
    name = _declared(element, net, "IdealPlanetary", f"ratio={ratio}")
    net.join(_compliant(element, net, words, port(element, "sun")), f"{name}.sun")
    for side in ("ring", "carrier"):
        net.join(port(element, side), f"{name}.{side}")
    if words.values(element.planet_inertia):
        # A planet rolls on the sun: against the carrier it turns by -2/(z - 1) of what the sun does.
        roll = _declared(element, net, "IdealGear", f"ratio=-({ratio} - 1)/2, useSupport=true", "_planet_mesh")
        total = f"{element.planets}*{factor(words.expression(element.planet_inertia))}"
        net.join(port(element, "sun"), f"{roll}.flange_a")
        net.join(port(element, "carrier"), f"{roll}.support")
        net.join(f"{roll}.flange_b", f"{_declared(element, net, 'Inertia', f'J={total}', '_planets')}.flange_a")
    if words.values(element.planet_mass) and words.values(element.orbit_radius):
        mass, radius = (factor(words.expression(value)) for value in (element.planet_mass, element.orbit_radius))
        orbit = _declared(element, net, "Inertia", f"J={element.planets}*{mass}*{radius}^2", "_orbit")
        net.join(port(element, "carrier"), f"{orbit}.flange_a")


def _differential(element: Differential, net: Net, words: ModelicaWords) -> None:
    del words
    sides = {"cage": "carrier", "left": "sun", "right": "ring"}
    if element.locked:
        net.join(*(port(element, side) for side in sides))
        return
    name = _declared(element, net, "IdealPlanetary", "ratio=1")
    for ours, theirs in sides.items():
        net.join(port(element, ours), f"{name}.{theirs}")


def _shaft(element: Shaft, net: Net, words: ModelicaWords) -> None:
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
    points = [port(element, "first"), *(f"inside:{node}" for node in element.internal_nodes), port(element, "second")]
    for index in range(n):
        suffix = f"_{index + 1}" if n > 1 else ""
        values = f"c={stiffness}, d={damping!r}" if damping else f"c={stiffness}"
        name = _declared(element, net, "SpringDamper" if damping else "Spring", values, suffix)
        net.join(points[index], f"{name}.flange_a")
        net.join(points[index + 1], f"{name}.flange_b")
        if element.inertia != "none":
            _segment_inertia(element, net, inertia, points[index : index + 2], suffix)


def _power(words: ModelicaWords, value: Any) -> str:
    return f"{factor(words.expression(value))}^4"


def _segment_inertia(element: Shaft, net: Net, inertia: str, ends: list[str], suffix: str) -> None:
    """Inertia of a segment on its ends; a consistent one by Simpson's rule, two thirds on the mean angle."""
    share = 6 if element.inertia == "consistent" else 2
    for end, side in zip(ends, "ab", strict=True):
        lump = _declared(element, net, "Inertia", f"J={inertia}/{share}", f"{suffix}_inertia_{side}")
        net.join(end, f"{lump}.flange_a")
    if element.inertia == "consistent":
        mean = _declared(element, net, "IdealPlanetary", "ratio=1", f"{suffix}_mean")
        middle = _declared(element, net, "Inertia", f"J=2*{inertia}/3", f"{suffix}_inertia_mean")
        net.join(ends[0], f"{mean}.sun")
        net.join(ends[1], f"{mean}.ring")
        net.join(f"{mean}.carrier", f"{middle}.flange_a")


WRITERS: dict[type[Element], Writer] = {
    Inertia: _inertia,
    Spring: _spring,
    HystereticSpring: _spring,
    Damper: _damper,
    RigidCoupling: _coupling,
    Lock: _lock,
    Gear: _gear,
    Planetary: _planetary,
    Differential: _differential,
    Shaft: _shaft,
}
"""Element types that have a counterpart, a hysteretic spring as far as its loss factor is zero."""


def has_counterpart(element: Element, values: Values) -> bool:
    """Whether Modelica's components can act as the element does."""
    if type(element) not in WRITERS:
        return False
    return not any(isinstance(part, Law) and part.loss_factor for part in element.parts(values))
