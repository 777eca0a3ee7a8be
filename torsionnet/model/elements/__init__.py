"""Element types, one class each with its ports, parameters and laws.

A file of this package is imported when the type that it is named after is first asked for, and all of them when types
are listed: a model then costs only the types that it has.
"""

from typing import TYPE_CHECKING

from torsionnet.model.element_base.element import (
    ELEMENT_TYPES,
    Element,
    element_class,
    element_classes,
    make_element,
    register,
)
from torsionnet.model.element_base.laws import GROUND, Action, Constraint, Law, MotionLaw, Part, Row, Values

if TYPE_CHECKING:
    from torsionnet.model.elements.element_types import *

__all__ = [
    "ELEMENT_TYPES",
    "GROUND",
    "Action",
    "Constraint",
    "Element",
    "Law",
    "MotionLaw",
    "Part",
    "Row",
    "Values",
    "element_classes",
    "make_element",
    "register",
]


def __getattr__(name: str) -> object:
    """Class of an element type by its name, imported at first use."""
    element_type = element_class(name) if name[:1].isupper() else None
    if element_type is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)
    return element_type
