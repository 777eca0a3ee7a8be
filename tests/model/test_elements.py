"""One contract for every element type."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.models import EVERY_ELEMENT, SHEET

import torsionnet as tn
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.entries.spec import Renaming, spec_of
from torsionnet.model.element_base.element_entries import NodeName, NodePair
from torsionnet.model.elements import ELEMENT_TYPES, Action, Constraint, Law, Values, make_element

KINDS = sorted(ELEMENT_TYPES)


@pytest.mark.parametrize("kind", KINDS)
class TestContract:
    def test_survives_the_way_through_a_file(self, kind):
        element = EVERY_ELEMENT[kind]
        data = element.to_data()
        assert data.pop("type") == kind
        with files_beside(SHEET.parent):
            assert make_element(kind, "e", data) == element

    def test_fields_say_what_they_are(self, kind):
        cls = ELEMENT_TYPES[kind]
        assert cls.glyph
        assert cls.__doc__
        for declared in cls.declared():
            spec = spec_of(declared)
            assert spec.description
            assert spec.schema()

    def test_rows_name_only_own_nodes_and_rest_in_rigid_rotation(self, kind):
        """Connections feel no common rotation; only inertias and clamps do."""
        element = EVERY_ELEMENT[kind]
        nodes = {*element.ports.values(), *element.internal_nodes}
        for part in element.parts(Values({})):
            assert set(part.row) <= nodes
            if isinstance(part, Action):  # its torque may come from ground
                assert set(part.sensed) <= nodes
                continue
            table = None if isinstance(part, Constraint) else part.table
            massless = isinstance(part, Constraint) or (part.inertia == 0 and (table is None or table.is_elastic))
            if massless and kind != "lock":
                assert sum(part.row.values()) == 0

    def test_coefficients_are_never_negative(self, kind):
        element = EVERY_ELEMENT[kind]
        for part in element.parts(Values({})):
            if isinstance(part, Law):
                assert min(part.inertia, part.stiffness, part.loss_factor) >= 0
                assert part.damping >= 0 or element.may_feed

    def test_all_its_names_are_renamed_in_a_part(self, kind):
        """Nothing of the part may be left that would mean something else in the whole; only ground stays."""
        element = EVERY_ELEMENT[kind]
        one = element.renamed(Renaming("left.", {"ground": "ground"}))
        nodes = [*one.ports.values(), *one.internal_nodes]
        rows = [part.row for part in one.parts(Values({}))]
        rows += [part.sensed for part in one.parts(Values({})) if isinstance(part, Action)]
        names = [name for _, _, expression, _ in one.expressions() for name in expression.names]
        assert all(name.startswith("left.") for name in (*nodes, *names) if name != "ground")
        assert all(node.startswith("left.") for row in rows for node in row)
        assert [len(row) for row in rows] == [
            length for part in element.parts(Values({})) for length in [len(part.row)]
        ] + [len(part.sensed) for part in element.parts(Values({})) if isinstance(part, Action)]

    def test_ground_drops_out(self, kind):
        """From every port that may stand there."""
        element, grounded = EVERY_ELEMENT[kind], []
        for name, spec in element.specs():
            if isinstance(spec, NodePair):
                grounded.append(replace(element, **{name: (element.nodes[0], "ground")}))
            elif isinstance(spec, NodeName) and spec.allow_ground:
                grounded.append(replace(element, **{name: "ground"}))
        for one in grounded:
            assert all("ground" not in part.row for part in one.parts(Values({})))

    def test_nonsense_is_refused_with_the_name_of_the_field(self, kind):
        cls = ELEMENT_TYPES[kind]
        for declared in cls.declared():
            if declared.name in ("description", "enabled"):
                continue
            with pytest.raises(tn.ModelError) as caught:
                replace(EVERY_ELEMENT[kind], **{declared.name: object()})
            assert caught.value.faults[0].path[:3] == ("elements", "e", declared.name)


def test_consistent_inertia_is_the_two_node_bar():
    shaft = tn.Shaft("s", nodes=("a", "b"), outer_diameter=0.05, length=1.2)
    matrix = np.zeros((2, 2))
    for law in shaft.parts(Values({})):
        row = np.array([float(law.row.get(node, 0)) for node in ("a", "b")])
        matrix += float(law.inertia) * np.outer(row, row)
    whole = 7850 * np.pi * 0.05**4 / 32 * 1.2
    np.testing.assert_allclose(matrix, whole / 6 * np.array([[2, 1], [1, 2]]), rtol=1e-12)


def test_planets_roll_on_the_sun():
    """Ring held, sun turning once: carrier 1/(1+z), planets -(z-1)/2 of the way back relative to the carrier."""
    z = Fraction(72, 30)
    mesh, spin, orbit = EVERY_ELEMENT["planetary"].parts(Values({}))
    assert mesh.row == {"a": 1, "b": z, "c": -(1 + z)}
    carrier = 1 / (1 + z)
    planet = spin.row["c"] * carrier + spin.row["a"]
    assert planet == carrier - 2 * (1 - carrier) / (z - 1)
    assert (spin.inertia, orbit.inertia) == (Fraction(3, 10), 3 * 2 * Fraction(3, 10) ** 2)


def test_teeth_of_opposite_sign_turn_the_sense():
    assert tn.Gear("g", nodes=("a", "b"), teeth=(20, -37)).parts(Values({}))[0].row == {"a": 1, "b": Fraction(37, 20)}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: tn.Gear("g", nodes=("a", "b")), r"elements\.g: .*missing-entry"),
        (lambda: tn.Gear("g", nodes=("a", "b"), ratio=2, teeth=(1, 2)), r"elements\.g\.teeth: .*contradicting-entries"),
        (lambda: tn.Gear("g", nodes=("a", "b"), ratio=2, damping=3), r"elements\.g\.damping: .*missing-entry"),
        (lambda: tn.Gear("g", nodes=("a", "ground"), ratio=2), r"elements\.g\.nodes: .*grounded-node"),
        (lambda: tn.Planetary("g", sun="a", ring="a", carrier="b", ratio=2), r"elements\.g: .*same-node"),
        (
            lambda: tn.Planetary("g", sun="a", ring="b", carrier="c", teeth=(60, 30)),
            r"elements\.g\.teeth: .*contradicting-values",
        ),
        (lambda: tn.Spring("s", nodes=("a", "a"), stiffness=1), r"elements\.s\.nodes\.1: .*same-node"),
        (lambda: tn.Spring("s", nodes="ab", stiffness=1), r"elements\.s\.nodes: .*not-a-node"),
        (
            lambda: tn.Spring("s", nodes=("a", "b"), stiffness=1, damping={"zeta": 0.1}),
            r"elements\.s\.damping: .*missing-entry",
        ),
        (
            lambda: tn.Spring("s", nodes=("a", "b"), stiffness=1, damping={"zata": 0.1, "at": 1}),
            r"elements\.s\.damping\.zata: .*unknown-word",
        ),
        (lambda: tn.Inertia("1j", node="a", inertia=1), r"elements\.1j: .*invalid-name"),
        (lambda: tn.Inertia("j", node="ground", inertia=1), r"elements\.j\.node: .*grounded-node"),
        (lambda: tn.Inertia("j", node="a", inertia="3 kg*m"), r"elements\.j\.inertia: .*wrong-unit"),
        (lambda: tn.Inertia("j", node="a", inertia=True), r"elements\.j\.inertia: .*not-a-number"),
        (
            lambda: tn.TabulatedSpring("t", nodes=("a", "b"), table=[[2, 1, 0], [1, 1, 0]]),
            r"elements\.t\.table\.1\.0: .*unordered-rows",
        ),
    ],
)
def test_contradictions_are_named(make, words):
    with pytest.raises(tn.ModelError, match=words):
        make()


def test_compliance_is_inverted_where_a_stiffness_is_wanted():
    spring = tn.Spring("s", nodes=("a", "b"), stiffness="0.002 rad/Nm")
    assert spring.stiffness.evaluate({}) == 500


@pytest.mark.parametrize("kind", ["spring", "hysteretic_spring", "shaft", "continuous_shaft"])
def test_a_bore_is_smaller_than_its_shaft(kind):
    with pytest.raises(tn.ModelError, match=r"elements\.e\.inner_diameter: .*contradicting-values"):
        replace(EVERY_ELEMENT[kind], outer_diameter="50 mm", inner_diameter="50 mm")


def test_every_family_of_types_is_a_file_so_that_an_unknown_kind_is_told():
    """A family whose file is missing would have every file imported for each of its kinds."""
    families = ELEMENT_TYPES.families
    assert all(ELEMENT_TYPES[kind].__module__ == f"torsionnet.model.elements.{families[kind]}" for kind in families)
    with pytest.raises(KeyError, match="nonsense"):
        ELEMENT_TYPES["nonsense"]
