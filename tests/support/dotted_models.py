"""Models as a part of another model, with dots in all names."""

from dataclasses import replace

import torsionnet as tn
from torsionnet.base.entries.spec import Renaming
from torsionnet.model.defining import flatten_definition
from torsionnet.model.definition import Definition
from torsionnet.model.parts.authored_model import part_of
from torsionnet.model.parts.part import Use


def in_a_part(definition):
    """The model as the part ``rig`` of a model that holds nothing else; parts of its own are put in before."""
    ports = {name: element.ports for name, element in definition.elements.items()}
    names = Renaming("rig.", {"ground": "ground"}, {*definition.inputs, *definition.sensors}, ports)
    return Definition(
        name=definition.name,
        parts={"model": part_of(replace(definition, authored=None))[0]},
        use={"rig": Use(part="model")},
        operating_point=definition.operating_point.renamed(names),
        speeds=definition.speeds and definition.speeds.renamed(names),
        load=loaded_in_the_whole(definition),
    )


def loaded_in_the_whole(definition):
    """A part has no load; what follows it in a part follows that of the whole."""
    load = definition.load
    if not any(parameter.by in ("load", "mean_torque") for parameter in definition.following.values()):
        return None
    return replace(
        load,
        absorbed_at=load.absorbed_at and f"rig.{load.absorbed_at}",
        driven_by=load.driven_by and {f"rig.{name}": share for name, share in load.driven_by.items()},
    )


def dotted(model):
    flat, faults = flatten_definition(in_a_part(model.definition))
    assert faults == []
    return tn.Drivetrain.from_definition(flat)
