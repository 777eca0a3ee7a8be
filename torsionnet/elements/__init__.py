"""The element types. One class is one place: ports, parameters, laws; importing this package registers them all."""

from torsionnet.elements.base import ELEMENT_TYPES, Element, make_element, register
from torsionnet.elements.gears import Differential, Gear, Planetary
from torsionnet.elements.inertia import Inertia
from torsionnet.elements.laws import GROUND, Constraint, Law, Part, Row, Values
from torsionnet.elements.rigid import Lock, RigidCoupling
from torsionnet.elements.shaft import Shaft
from torsionnet.elements.springs import Damper, HystereticSpring, Spring, TabulatedSpring

__all__ = [
    "ELEMENT_TYPES",
    "GROUND",
    "Constraint",
    "Damper",
    "Differential",
    "Element",
    "Gear",
    "HystereticSpring",
    "Inertia",
    "Law",
    "Lock",
    "Part",
    "Planetary",
    "RigidCoupling",
    "Row",
    "Shaft",
    "Spring",
    "TabulatedSpring",
    "Values",
    "make_element",
    "register",
]
