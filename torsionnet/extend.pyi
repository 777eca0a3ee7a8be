# Written by `make generate`.
from torsionnet.base.entries.composite import one_at_most as one_at_most
from torsionnet.base.entries.composite import one_exactly as one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity as PhysicalQuantity
from torsionnet.base.entries.spec import Count as Count
from torsionnet.base.entries.spec import Flag as Flag
from torsionnet.base.entries.spec import OneOf as OneOf
from torsionnet.base.entries.spec import entry as entry
from torsionnet.base.errors import Fault as Fault
from torsionnet.base.expressions import Expression as Expression
from torsionnet.model.damping import DampingQuantity as DampingQuantity
from torsionnet.model.damping import LossFactor as LossFactor
from torsionnet.model.damping import loss_factor as loss_factor
from torsionnet.model.element_base.element import Element as Element
from torsionnet.model.element_base.element import register as register
from torsionnet.model.element_base.element import viscous as viscous
from torsionnet.model.element_base.element_entries import NodeName as NodeName
from torsionnet.model.element_base.element_entries import NodePair as NodePair
from torsionnet.model.element_base.laws import Action as Action
from torsionnet.model.element_base.laws import Constraint as Constraint
from torsionnet.model.element_base.laws import Law as Law
from torsionnet.model.element_base.laws import MotionLaw as MotionLaw
from torsionnet.model.element_base.laws import Part as Part
from torsionnet.model.element_base.laws import Values as Values
from torsionnet.model.element_base.laws import difference as difference
from torsionnet.model.element_base.laws import make_row as make_row

__all__ = [
    "Action",
    "Constraint",
    "Count",
    "DampingQuantity",
    "Element",
    "Expression",
    "Fault",
    "Flag",
    "Law",
    "LossFactor",
    "MotionLaw",
    "NodeName",
    "NodePair",
    "OneOf",
    "Part",
    "PhysicalQuantity",
    "Values",
    "difference",
    "entry",
    "loss_factor",
    "make_row",
    "one_at_most",
    "one_exactly",
    "register",
    "viscous",
]
