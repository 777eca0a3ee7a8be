"""The element types. One class is one place: ports, parameters, laws; importing this package registers them all."""

from torsionnet.model.elements.element import ELEMENT_TYPES, Element, make_element, register
from torsionnet.model.elements.gears import Differential, Gear, Planetary
from torsionnet.model.elements.inertia import Inertia
from torsionnet.model.elements.laws import GROUND, Constraint, Law, Part, Row, Values
from torsionnet.model.elements.rigid import Lock, RigidCoupling
from torsionnet.model.elements.shaft import Shaft
from torsionnet.model.elements.springs import Damper, HystereticSpring, Spring, TabulatedSpring

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
