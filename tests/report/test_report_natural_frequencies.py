"""Natural frequencies counted alike, nodes of vibration, and their section in the document for approval."""

import numpy as np
import pytest
from support.report_blocks import of, rows, words

import torsionnet as tn
from torsionnet.machinery.holzer.holzer import natural_frequencies
from torsionnet.machinery.holzer.holzer_table import vibration_nodes
from torsionnet.report import make_report
from torsionnet.report.document_tree import Paragraph, Picture, TableBlock
from torsionnet.report.report_data import ReportData, cases_of
from torsionnet.report.report_request import ReportRequest
from torsionnet.report.sections.natural_frequencies import natural_frequencies_section

J, k = [2.0, 1.0, 3.0, 0.5], [1e4, 3e4, 2e4]
NAMES = ["a", "b", "c", "d"]


def line(ratio=1.0):
    """Four masses in a line; with a ratio, the second shaft turns ratio times as fast behind a rigid gear."""
    elements = [tn.Inertia(f"J_{name}", node=name, inertia=value) for name, value in zip(NAMES, J, strict=True)]
    elements += [
        tn.Spring("s1", nodes=("a", "b"), stiffness=k[0]),
        tn.Spring("s2", nodes=("b", "c" if ratio == 1 else "g"), stiffness=k[1]),
        tn.Spring("s3", nodes=("c", "d"), stiffness=k[2]),
    ]
    if ratio != 1:
        elements.append(tn.Gear("gear", nodes=("g", "c"), ratio=1 / ratio))
    return tn.Drivetrain("line", elements)


def dense(ratio=1.0):
    """Natural frequencies in Hz and shapes referred to the first shaft, from dense matrices."""
    factor = np.array([1, 1, ratio**2, ratio**2])
    M, K = np.diag(np.array(J) * factor), np.zeros((4, 4))
    for place, value in enumerate(np.array(k) * [1, 1, ratio**2]):
        K[place : place + 2, place : place + 2] += value * np.array([[1, -1], [-1, 1]])
    scale = 1 / np.sqrt(np.diag(M))
    values, vectors = np.linalg.eigh(K * np.outer(scale, scale))
    return np.sqrt(np.abs(values[1:])) / (2 * np.pi), (vectors * scale[:, None])[:, 1:]


@pytest.mark.parametrize("ratio", [1.0, 2.5, -2.5])
class TestLine:
    def test_frequencies_and_numbers_of_nodes(self, ratio):
        frequencies, shapes = dense(ratio)
        found = natural_frequencies(line(ratio))
        assert [one.mode for one in found] == [1, 2, 3]
        assert [one.undamped_frequency for one in found] == pytest.approx(frequencies.tolist(), rel=1e-9)
        assert [one.per_minute for one in found] == pytest.approx((60 * frequencies).tolist(), rel=1e-9)
        changes = [int(np.sum(shape[:-1] * shape[1:] < 0)) for shape in shapes.T]
        assert [one.n_nodes for one in found] == changes == [1, 2, 3]

    def test_places_of_the_nodes(self, ratio):
        _, shapes = dense(ratio)
        for mode in (1, 2, 3):
            theta = shapes[:, mode - 1]
            expected = [theta[n] / (theta[n] - theta[n + 1]) for n in range(3) if theta[n] * theta[n + 1] < 0]
            found = vibration_nodes(line(ratio).holzer_table(mode))
            assert [one.position for one in found] == pytest.approx(expected, rel=1e-8)

    def test_nothing_remains_of_the_residual(self, ratio):
        """The Holzer sum of J w^2 theta over all masses, with the dense frequency and the stations' amplitudes."""
        frequencies, _ = dense(ratio)
        for mode in (1, 2, 3):
            holzer = line(ratio).holzer_table(mode)
            total = [one.inertia * (2 * np.pi * frequencies[mode - 1]) ** 2 * one.amplitude / (1 if one.node in "abg" else 1 / ratio)
                     for one in holzer.branches[0].stations]  # fmt: skip
            assert sum(total) == pytest.approx(0, abs=1e-7 * max(map(abs, total)))


def test_what_swings_against_what():
    found = natural_frequencies(line())
    _, shapes = dense()
    energies = np.array(J) * shapes[:, 0] ** 2
    largest = NAMES[int(np.argmax(energies))]
    assert found[0].against.split(" against ")[0].split(", ")[0] == largest


def test_a_mass_at_rest_is_a_node_once():
    ends = [tn.Inertia(name, node=name, inertia=1) for name in ("a", "b", "c")]
    springs = [tn.Spring(f"k_{one}{two}", nodes=(one, two), stiffness=1e4) for one, two in ("ab", "bc")]
    rig = tn.Drivetrain("symmetric", [*ends, *springs])
    (node,) = vibration_nodes(rig.holzer_table(1))
    assert (node.first, node.second, node.elements) == ("b", "b", ())
    assert [one.n_nodes for one in natural_frequencies(rig)] == [1, 2]


@pytest.mark.slow
def test_numbers_are_those_of_every_other_table():
    """With a strong damper, whose own mode is overdamped and counted behind all others."""
    rig = tn.load("marine_medium_speed").configured("water=wet,coupling=warm,firing=normal")
    found = natural_frequencies(rig)
    met = {one.number: one for one in rig.critical_speeds().modes}
    for one in found:
        assert one.undamped_frequency == pytest.approx(met[one.mode].undamped_frequency, nan_ok=True)
    modes = rig.modes()
    for index, number in enumerate(modes.numbers):
        if number is not None:
            assert found[number - 1].natural_frequency == pytest.approx(modes.natural_frequencies[index])


def test_picture_marks_each_node_once():
    from torsionnet.plot.shapes import relative_amplitudes

    tables = [line().holzer_table(mode) for mode in (1, 2)]
    for panel, count in zip(relative_amplitudes(tables).axes, (1, 2), strict=True):
        rings = [one for one in panel.lines if len(one.get_xdata()) == 1]
        assert len(rings) == count
    with pytest.raises(tn.UsageError, match="no Holzer table"):
        relative_amplitudes([])


def test_a_branch_stands_a_little_apart_from_the_line_before():
    """Masses of a line are one step from each other, and the first of a branch BRANCH_STEP from the last before it."""
    from torsionnet.plot.shapes import BRANCH_STEP, relative_amplitudes

    masses = [tn.Inertia(name, node=name, inertia=1) for name in "abcdef"]
    shafts = [tn.Spring("_".join(pair), nodes=tuple(pair), stiffness=1e4) for pair in ("ab", "bc", "cd", "be", "ef")]
    holzer = tn.Drivetrain("branched", [*masses, *shafts]).holzer_table(1)
    (axes,) = relative_amplitudes([holzer]).axes
    lines = [one.get_xdata() for one in axes.lines if len(one.get_xdata()) > 2]
    assert sorted(map(len, lines)) == [3, 4]
    assert {step for one in lines for step in np.diff(one)} == {1.0}
    assert lines[1][0] - lines[0][-1] == pytest.approx(BRANCH_STEP)


def section(model, **options):
    (found,) = make_report(model, sections=["natural_frequencies"], date=None, **options).sections
    return found


def captions(found):
    return [str(one.caption) for one in of(TableBlock, found.blocks)]


class TestSection:
    def test_numbers_are_those_of_the_function(self):
        found = section("bulk_carrier")
        expected = natural_frequencies(tn.load("bulk_carrier").configured("normal"))
        shown = rows(of(TableBlock, found.blocks)[0])
        assert len(shown) == 3  # two below order 15 at 108 r/min, 27 Hz, and the next one
        for row, one in zip(shown, expected[:3], strict=True):
            assert float(row[1]) == pytest.approx(one.undamped_frequency, abs=0.006)
            assert float(row[2]) == pytest.approx(60 * one.undamped_frequency, abs=0.06)
            assert float(row[4]) == pytest.approx(100 * one.damping_ratio, abs=0.006)
            assert int(row[5]) == one.n_nodes
        first = next(text for text in captions(found) if "Holzer" in text)
        assert first.startswith("('Holzer table of mode 1, 5.10")
        assert len(of(Picture, found.blocks)) == 1

    @pytest.mark.parametrize(("count", "tables"), [(0, 0), (1, 1), (3, 3)])
    def test_number_of_holzer_tables_is_chosen(self, count, tables):
        text = tn.load("bulk_carrier").to_yaml().replace("report: {", f"report: {{holzer: {count}, ")
        assert sum("Holzer" in one for one in captions(section(tn.loads(text)))) == tables

    def test_faulty_number_is_refused_in_its_place(self):
        text = tn.load("bulk_carrier").to_yaml().replace("report: {", "report: {holzer: many, ")
        with pytest.raises(tn.ModelError, match="holzer"):
            tn.loads(text)

    @pytest.mark.slow
    def test_all_conditions_have_their_drivetrain(self):
        """Three couplings, with and without water: six drivetrains out of eighteen conditions."""
        marine = tn.load("marine_medium_speed")
        found = natural_frequencies_section(ReportData(marine, cases_of(marine, ()), ReportRequest()))
        compared = of(TableBlock, found.blocks)[1]
        assert [len(group.rows) for group in compared.groups[:3]] == [6, 6, 6]
        assert any("5 further modes lie below" in "".join(one.text) for one in of(Paragraph, found.blocks))

    @pytest.mark.slow
    def test_branches_of_a_planetary_train_are_groups_of_one_table(self):
        found = section("wind_turbine_3mw")
        holzer = [one for one in of(TableBlock, found.blocks) if "Holzer" in str(one.caption)]
        assert len(holzer) == 3
        assert holzer[2].groups[0].title == "car1 to blade3.tip"
        assert [row[0] for row in holzer[2].groups[0].rows] == ["car1", "hub", "blade3.tip"]  # the shaft is one row

    @pytest.mark.slow
    def test_nodes_along_branches_are_where_the_shape_changes_its_sign(self):
        """A planetary set ties three shafts: nodes are not counted, but each blade has one where it swings with others.

        The shapes are those of the damped modes, which do not come from Holzer tables.
        """
        (table, *_) = of(TableBlock, section("wind_turbine_3mw").blocks)
        assert any(str(note[0]).startswith("Nodes are not counted where") for note in table.notes)
        heads = [words(one.text) for one in table.columns]
        assert "Nodes" not in heads
        told = {row[0]: row[heads.index("Nodes of vibration")] for row in rows(table)}
        modes = tn.load("wind_turbine_3mw").configured("free").modes()
        for number in (3, 4, 5):
            shape = modes.shapes[:, list(modes.numbers).index(number)]
            at = {name: shape[list(modes.nodes).index(name)] for name in ("hub", *(f"blade{i}.tip" for i in (1, 2, 3)))}
            signs = [(at[f"blade{i}.tip"] / at["hub"]).real for i in (1, 2, 3)]
            assert [f"blade{i}.edge" in told[str(number)] for i in (1, 2, 3)] == [sign < 0 for sign in signs]

    def test_a_node_on_a_branch_lies_in_an_element_or_at_a_mass(self):
        """Two equal arms swing against each other at sqrt(k/J), and the hub between them, with all else, is at rest."""
        masses = {
            "sun": 0.3,
            "ring": 2.0,
            "carrier": 4.0,
            "motor": 0.7,
            "left": 1.0,
            "hub": 2.0,
            "right": 1.0,
            "tip": 3.0,
        }
        springs = {
            ("carrier", "tip"): 2e4,
            ("motor", "sun"): 1e3,
            ("ring", "hub"): 5e3,
            ("left", "hub"): 1e4,
            ("hub", "right"): 1e4,
        }
        rig = tn.Drivetrain(
            "tied",
            [
                tn.Planetary("set", sun="sun", ring="ring", carrier="carrier", ratio=3),
                *(tn.Inertia(f"J_{node}", node=node, inertia=inertia) for node, inertia in masses.items()),
                *(tn.Spring("_".join(nodes), nodes=nodes, stiffness=value) for nodes, value in springs.items()),
            ],
            speeds={"of": "sun", "list": ["100 rpm", "900 rpm"]},
            excitations={"e": {"type": "harmonic", "node": "sun", "orders": {2: {"amplitude": 1}}}},
        )
        (table, *_) = of(TableBlock, section(rig).blocks)
        told = {row[1]: row[5] for row in rows(table)}
        assert told[f"{np.sqrt(1e4) / (2 * np.pi):.2f}"] == "at hub"
        assert told[rows(table)[0][1]] == "in motor sun, in ring hub"

    def test_models_without_excitations_have_none(self):
        assert make_report("dmf_rig", sections=["natural_frequencies"], date=None).sections == ()


def test_torques_of_rounding_twist_no_shaft_in_the_table():
    """Of 1e6 N m, 1e-5 N m is less than a double tells, 1e-2 is not."""
    from dataclasses import replace

    from torsionnet.report.sections.natural_frequencies import _without_rounding

    holzer = line().holzer_table(1)
    (branch,) = holzer.branches
    for least, is_rounded in ((1e-5, True), (1e-2, False)):
        torques = [1e6, least, *(one.torque for one in branch.stations[2:])]
        stations = [replace(one, torque=torque) for one, torque in zip(branch.stations, torques, strict=True)]
        changed = replace(holzer, branches=(replace(branch, stations=tuple(stations)),))
        twist = _without_rounding(changed).branches[0].stations[1].link.twist
        assert (twist == 0) == is_rounded
