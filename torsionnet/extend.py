"""Element types of one's own: the base class, entries, laws, and the register of element types.

A package makes its element types known to model files, the command line, the schema and editors by an entry point of
the group ``torsionnet.elements`` in its ``pyproject.toml``, named as the kind:

.. code-block:: toml

    [project.entry-points."torsionnet.elements"]
    absorber = "torsionnet_absorber:Absorber"

They are looked up where a file names a type that torsionnet does not have, and where all types are listed.
"""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Action": "torsionnet.model.element_base.laws",
        "Constraint": "torsionnet.model.element_base.laws",
        "Count": "torsionnet.base.entries.spec",
        "DampingQuantity": "torsionnet.model.damping",
        "Element": "torsionnet.model.element_base.element",
        "Expression": "torsionnet.base.expressions",
        "Fault": "torsionnet.base.errors",
        "Flag": "torsionnet.base.entries.spec",
        "Law": "torsionnet.model.element_base.laws",
        "LossFactor": "torsionnet.model.damping",
        "MotionLaw": "torsionnet.model.element_base.laws",
        "NodeName": "torsionnet.model.element_base.element_entries",
        "NodePair": "torsionnet.model.element_base.element_entries",
        "OneOf": "torsionnet.base.entries.spec",
        "Part": "torsionnet.model.element_base.laws",
        "PhysicalQuantity": "torsionnet.base.entries.scalars",
        "Values": "torsionnet.model.element_base.laws",
        "difference": "torsionnet.model.element_base.laws",
        "entry": "torsionnet.base.entries.spec",
        "loss_factor": "torsionnet.model.damping",
        "make_row": "torsionnet.model.element_base.laws",
        "one_at_most": "torsionnet.base.entries.composite",
        "one_exactly": "torsionnet.base.entries.composite",
        "register": "torsionnet.model.element_base.element",
        "viscous": "torsionnet.model.element_base.element",
    },
)
