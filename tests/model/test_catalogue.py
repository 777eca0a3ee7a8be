"""Entries of elements and limits out of catalogues."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.io import mass_elastic_report, read_catalogue
from torsionnet.model.catalogues.catalogue_reading import shipped_catalogues

COUPLINGS = """\
# made-up couplings
size;stiffness [kN*m/rad];loss_factor.psi;T_KN [kN*m];T_KW [kN*m];P_KV [W];description
A350;11,2;0,78;3,5;0,88;260;rubber
B1.000;34;1,0;10;3,0;450;soft
"""
MODEL = """\
torsionnet: 1
name: two masses
elements:
  motor: {type: inertia, node: a, inertia: 2}
  load: {type: inertia, node: b, inertia: 3}
  coupling: {type: hysteretic_spring, nodes: [a, b], catalogue: couplings.csv, size: A350}
limits:
  coupling: {rule: coupling, element: coupling}
"""


def load(tmp_path, model=MODEL, catalogue=COUPLINGS):
    (tmp_path / "couplings.csv").write_text(catalogue, encoding="utf-8")
    (tmp_path / "model.yaml").write_text(model, encoding="utf-8")
    return tn.load(tmp_path / "model.yaml")


def notes(tmp_path, *change):
    return [fault.message for fault in load(tmp_path, *change).check() if fault.severity == "note"]


def test_the_same_as_written_out(tmp_path):
    by_size = load(tmp_path)
    out = "stiffness: 11.2 kN*m/rad, loss_factor: {psi: 0.78}"
    by_hand = load(tmp_path, MODEL.replace("catalogue: couplings.csv, size: A350", out).partition("limits:")[0])
    np.testing.assert_array_equal(by_size.modes().eigenvalues, by_hand.modes().eigenvalues)
    # |k (1 + j psi/2 pi)| with the reduced inertia: two free masses by hand.
    stiffness = 11200 * abs(1 + 1j * 0.78 / (2 * np.pi))
    frequency = np.sqrt(stiffness * (1 / 2 + 1 / 3)) / (2 * np.pi)
    assert by_size.modes().natural_frequencies[1] == pytest.approx(frequency, rel=1e-9)
    assert by_size.elements["coupling"].description == "rubber"


def test_entries_of_the_model_win(tmp_path):
    given = load(tmp_path, MODEL.replace("size: A350", "size: A350, stiffness: 20 kN*m/rad"))
    assert float(given.elements["coupling"].stiffness.value) == 20e3
    assert "stiffness: 20 kN*m/rad" in given.to_yaml()


def test_a_configuration_may_choose_another_size(tmp_path):
    axis = "configurations: {coupling: {soft: {coupling.size: A350}, stiff: {coupling.size: B1.000}}}\n"
    stiff = load(tmp_path, MODEL + axis).configured("stiff")
    assert float(stiff.elements["coupling"].stiffness.value) == 34e3
    assert stiff.definition.limits["coupling"].fitted(stiff.elements).T_KN == 10e3
    own = load(tmp_path, (MODEL + axis).replace("size: A350}\n", "size: A350, stiffness: 7}\n")).configured("stiff")
    assert float(own.elements["coupling"].stiffness.value) == 7
    with pytest.raises(ModelError, match='has no size "B2"') as caught:
        load(tmp_path, MODEL + axis.replace("B1.000", "B2"))
    assert caught.value.faults[0].position.line == 9


def test_a_written_model_keeps_catalogue_and_size(tmp_path):
    model = load(tmp_path)
    text = model.to_yaml()
    assert "coupling: {type: hysteretic_spring, nodes: [a, b], catalogue: couplings.csv, size: A350}" in text
    assert "{rule: coupling, element: coupling}" in text
    assert tn.loads(text, folder=tmp_path).definition == model.definition


def test_a_limit_takes_what_it_is_not_told(tmp_path):
    model = load(tmp_path, MODEL.replace("element: coupling}", "element: coupling, T_KW: 1 kN*m}"))
    limit = model.definition.limits["coupling"].fitted(model.elements)
    assert (limit.T_KN, limit.T_KW, limit.P_KV) == (3500, 1000, 260)
    assert limit.T_Kmax is None
    assert limit.source == "catalogue couplings.csv, size A350"


def test_a_limit_judges_by_the_catalogue(tmp_path):
    """The torque of the coupling under a sine of 100 N m on one mass, by hand; T_KW is 880 N m."""
    running = MODEL + (
        "speeds: {of: a, list: [600 rpm, 900 rpm, 1200 rpm]}\n"
        "excitations: {shaker: {type: harmonic, node: a, orders: {1: {amplitude: 100 N*m}}}}\n"
    )
    model = load(tmp_path, running)
    verdicts = {one.criterion: one for one in model.check_limits().verdicts}
    assert set(verdicts["T_KW"].allowed) == {880.0}
    omega = np.pi / 30 * np.array([600, 900, 1200])
    k = 11200 * (1 + 1j * 0.78 / (2 * np.pi))
    torque = np.abs(100 * k * 3 * omega**2 / ((k - 2 * omega**2) * (k - 3 * omega**2) - k**2))
    # Half ranges are found on a grid of angles.
    np.testing.assert_allclose(verdicts["T_KW"].values, torque, rtol=1e-6)


def test_a_damper_limit_states_its_power_in_one_way(tmp_path):
    catalogue = "size;power [kW];vibratory_twist [deg]\nA350;2,4;0,5\n"
    limit = "{rule: damper, element: coupling, power_per_area: 5 kW/m^2, area: 1.4 m^2}"
    given = MODEL.replace("size: A350", "size: A350, stiffness: 1, loss_factor: 0").replace(
        "{rule: coupling, element: coupling}", limit
    )
    model = load(tmp_path, given, catalogue)
    fitted = model.definition.limits["coupling"].fitted(model.elements)
    assert (fitted.power, fitted.allowed_power) == (None, 7000)
    assert fitted.vibratory_twist == pytest.approx(np.radians(0.5))


def test_without_catalogue_a_limit_still_needs_a_value(tmp_path):
    plain = MODEL.replace("catalogue: couplings.csv, size: A350", "stiffness: 1, loss_factor: 0.1")
    with pytest.raises(ModelError, match=r":8:3: .*missing-entry"):
        load(tmp_path, plain)


@pytest.mark.parametrize(
    ("catalogue", "size", "kind", "file", "line"),
    [
        (COUPLINGS, "A355", "unknown-name", "model.yaml", 6),
        (COUPLINGS, "X", "unknown-name", "model.yaml", 6),
        (COUPLINGS + "A350;12;1;;;;\n", "A350", "repeated-name", "couplings.csv", 5),
        (COUPLINGS.replace("stiffness [kN*m/rad]", "stiffness"), "A350", "missing-unit",
         "couplings.csv", 2),
        (COUPLINGS.replace("kN*m/rad", "kg"), "A350", "wrong-unit", "couplings.csv", 3),
        (COUPLINGS.replace("kN*m/rad", "kNn/rad"), "A350", "unknown-unit", "couplings.csv", 2),
        (COUPLINGS.replace("kN*m/rad", "10^3 N*m/rad"), "A350", "wrong-unit", "couplings.csv", 2),
        (COUPLINGS.replace("T_KN [kN*m]", "T_KN"), "A350", "missing-unit", "couplings.csv", 2),
        (COUPLINGS.replace("size;", "name;"), "A350", "missing-column", "couplings.csv", 2),
        (COUPLINGS.replace("P_KV", "T_KN"), "A350", "repeated-name", "couplings.csv", 2),
    ],
)  # fmt: skip
def test_faults_have_their_place(tmp_path, catalogue, size, kind, file, line):
    with pytest.raises(ModelError) as caught:
        load(tmp_path, MODEL.replace("A350", size), catalogue)
    places = [(one.position.file.rpartition("/")[2], one.position.line) for one in caught.value.faults
              if one.kind == kind]  # fmt: skip
    assert places == [(file, line)], str(caught.value)
    assert "model.yaml" in {one.position.file.rpartition("/")[2] for one in caught.value.faults}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("couplings.csv", "coupling.csv"), r":6:65: .*missing-file"),
        (("couplings.csv", "../couplings.csv"), r":6:65: .*forbidden-file"),
        (("couplings.csv", "example_coupling"), 'did you mean "example_couplings"'),
        ((", size: A350", ""), r":6:54: .*missing-entry"),
        (("catalogue: couplings.csv, ", "stiffness: 1, loss_factor: 0, "), "add catalogue"),
    ],
)
def test_what_the_model_says_wrong(tmp_path, change, message):
    with pytest.raises(ModelError, match=message) as caught:
        load(tmp_path, MODEL.replace(*change))
    assert {one.position.line for one in caught.value.faults} == {6}


def test_columns_that_nothing_takes_are_a_note(tmp_path):
    assert not any("fits no entry" in note for note in notes(tmp_path))
    found = notes(tmp_path, MODEL, COUPLINGS.replace("T_KW", "T_KX"))
    assert any(('"T_KX"' in note and 'did you mean "T_KN"' in note) or "T_KX" in note for note in found)
    spring = MODEL.replace("hysteretic_spring", "spring").partition("limits")[0]
    assert any('"loss_factor"' in note for note in notes(tmp_path, spring))


class TestShipped:
    def test_tyres(self):
        car = tn.loads(
            "torsionnet: 1\nname: x\nelements:\n  hub: {type: inertia, node: hub, inertia: 1}\n"
            "  body: {type: inertia, node: road, inertia: 90}\n"
            "  tyre: {type: tyre, nodes: [hub, road], speed: 20 m/s, catalogue: example_tyres, size: R16}\n"
        )
        assert float(car.elements["tyre"].radius.value) == 0.304
        assert float(car.elements["tyre"].slip_stiffness.value) == 80e3

    @pytest.mark.parametrize("kind", ["hysteretic_spring", "spring", "flexible_coupling"])
    def test_couplings(self, kind):
        text = MODEL.replace("couplings.csv", "example_couplings").replace("hysteretic_spring", kind)
        for size in ("A100", "A350", "B630"):
            model = tn.loads(text.replace("A350", size))
            assert model.definition.limits["coupling"].fitted(model.elements).T_KN > 0

    def test_dampers(self):
        text = (
            "torsionnet: 1\nname: x\nelements:\n  d: {type: viscous_damper, node: a, catalogue: example_viscous_dampers"
        )
        for size in ("V240", "V1250"):
            damper = tn.loads(f"{text}, size: {size}}}\nlimits: {{d: {{rule: damper, element: d}}}}")
            assert not [fault for fault in damper.check() if "fits no entry" in fault.message]

    def test_all_have_sizes_once_and_units(self):
        assert set(shipped_catalogues()) == {"example_couplings", "example_tyres", "example_viscous_dampers"}
        for path in shipped_catalogues().values():
            head, *rows = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
            sizes = [row.split(",")[0] for row in rows]
            assert len(set(sizes)) == len(sizes) >= 5
            assert all(name in ("size", "description") or name.endswith("]") for name in head.split(","))


class TestInPython:
    @pytest.fixture
    def path(self, tmp_path):
        (tmp_path / "couplings.csv").write_text(COUPLINGS, encoding="utf-8")
        return tmp_path / "couplings.csv"

    @pytest.mark.parametrize("read", [lambda path: path, read_catalogue])
    def test_by_path_or_as_it_was_read(self, path, read):
        found = tn.HystereticSpring(
            "coupling", nodes=("a", "b"), stiffness=None, loss_factor=None, catalogue=read(path), size="A350"
        )
        assert float(found.stiffness.value) == 11200
        assert (found.catalogue.file, found.size, found.description) == ("couplings.csv", "A350", "rubber")

    def test_what_is_given_wins_and_sizes_are_listed(self, path):
        found = tn.HystereticSpring(
            "coupling", nodes=("a", "b"), stiffness=5, loss_factor=None, catalogue=path, size="B1.000"
        )
        assert float(found.stiffness.value) == 5
        assert read_catalogue(path).sizes == ("A350", "B1.000")

    @pytest.mark.parametrize(
        ("entries", "message"),
        [
            ({"size": "A351"}, r'elements\.c\.size: .*did you mean "A350".*unknown-name'),
            ({}, r"elements\.c\.catalogue: .*missing-entry"),
        ],
    )
    def test_what_is_missing_is_told(self, path, entries, message):
        with pytest.raises(ModelError, match=message):
            tn.HystereticSpring("c", nodes=("a", "b"), stiffness=None, loss_factor=None, catalogue=path, **entries)
        with pytest.raises(tn.UsageError, match="there is no file"):
            read_catalogue(path.with_name("other.csv"))
        with pytest.raises(ModelError, match=r"Path\('couplings.csv'\).*missing-file"):
            tn.Spring("c", nodes=("a", "b"), stiffness=1, catalogue="couplings.csv", size="A350")

    def test_a_sheet_by_path_or_as_it_was_read(self, tmp_path):
        path = tmp_path / "engine.csv"
        path.write_text("mass;J [kg m²];k [MNm/rad]\ncyl 1;0,45;2,1\nflywheel;14;", encoding="utf-8")
        first, second = (tn.MassElastic("e", table=one) for one in (path, mass_elastic_report(path)))
        assert [str(one) for one in first.expanded()] == [str(one) for one in second.expanded()]
        assert float(first.expanded()[0].inertia.value) == 0.45
