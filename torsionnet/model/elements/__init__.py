"""The element types. One class is one place: ports, parameters, laws; every file of this package is imported here."""

import importlib
import pkgutil
from typing import TYPE_CHECKING

from torsionnet.model.elements.element import ELEMENT_TYPES, Element, element_classes, make_element, register
from torsionnet.model.elements.laws import GROUND, Action, Constraint, Law, Part, Row, Values

if TYPE_CHECKING:
    from torsionnet.model.elements.element_types import *

for _name in sorted(module.name for module in pkgutil.iter_modules(__path__)):
    importlib.import_module(f"{__name__}.{_name}")

__all__ = [
    "ELEMENT_TYPES",
    "GROUND",
    "Action",
    "Constraint",
    "Element",
    "Law",
    "Part",
    "Row",
    "Values",
    "element_classes",
    "make_element",
    "register",
]


def __getattr__(name: str) -> object:
    """An element type by the name of its class."""
    classes = element_classes()
    if name not in classes:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name)
    return classes[name]
