"""Everything that names something is renamed when it is put into a model as a part of it."""

import pytest

import torsionnet as tn
from torsionnet.base.entries.spec import Renaming
from torsionnet.base.expression_reading import scalar
from torsionnet.machinery.excitations import excitation_kinds
from torsionnet.machinery.limits import limit_rules
from torsionnet.model.definition import Definition
from torsionnet.model.elements import ELEMENT_TYPES

NAMES = Renaming("left.", {"ground": "ground", "n1": "outer"})


def renamed_node(node):
    return {"ground": "ground", "n1": "outer"}.get(node, f"left.{node}")


@pytest.mark.parametrize("kind", ELEMENT_TYPES)
def test_every_element_type(kind, sample_of):
    element = sample_of(kind)
    found = element.renamed(NAMES)
    assert type(found) is type(element)
    assert found.name == f"left.{element.name}"
    assert found.ports == {port: renamed_node(node) for port, node in element.ports.items()}
    assert found.internal_nodes == tuple(f"left.{node}" for node in element.internal_nodes)
    before = [expression.names for _, _, expression, _ in element.expressions()]
    after = [expression.names for _, _, expression, _ in found.expressions()]
    assert after == [{f"left.{name}" for name in names} for names in before]


@pytest.fixture
def sample_of():
    """An element of each type whose values are all parameters of the name of their entry."""
    import importlib
    import sys
    from pathlib import Path

    docs = str(Path(__file__).parents[2] / "docs")
    sys.path.insert(0, docs)
    yield lambda kind: importlib.import_module("generate").sample(ELEMENT_TYPES[kind], full=True)
    sys.path.remove(docs)


@pytest.mark.slow
def test_every_excitation_and_limit_of_the_library():
    seen = set()
    for definition in (tn.load(name).definition for name in tn.library_models()):
        for one in definition.excitations.values():
            found = one.renamed(NAMES)
            seen.add(one.kind)
            assert found.nodes == tuple(map(renamed_node, one.nodes))
            assert found.shaft == (renamed_node(one.shaft) if one.shaft else one.shaft)
            if one.element_entry is not None:
                assert found.element_entry == (one.element_entry[0], f"left.{one.element_entry[1]}")
        for one in definition.limits.values():
            found = one.renamed(Renaming("left.", {"ground": "ground"}, set(definition.sensors)))
            seen.add(one.kind)
            wanted = [(path, what, f"left.{name}") for path, what, name in one.named]
            assert list(found.named) == wanted
    assert seen & set(excitation_kinds())
    assert seen & set(limit_rules())


def test_expressions_keep_their_form():
    tree = scalar("2*k_1 + sqrt(k_2)/3 - 0.5")
    assert str(NAMES.expression(tree)) == "2*left.k_1 + sqrt(left.k_2)/3 - 0.5"
    assert NAMES.expression(scalar("0.46 kN*m/rad")) is not None


def test_a_definition_has_every_section_of_a_part():
    from torsionnet.model.parts.flattening import SECTIONS

    whole_only = {"name", "source", "description", "include", "parts", "use", "ports"}
    whole_only |= {"operating_point", "speeds", "load", "scenarios", "bench", "report"}
    assert {name for name, _ in Definition.specs()} - whole_only == set(SECTIONS)
