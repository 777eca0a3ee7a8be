"""TORS files of openTorsion. Expected numbers are those of openTorsion 0.3.2 reading the same data (numpy 2.4.6)."""

import copy
import json
import random
import warnings
from datetime import date

import numpy as np
import pytest
from support.faults import placed_faults
from support.made_up_elements import EXPORTED
from support.tors_models import THRUSTER, random_tree

import torsionnet as tn
from torsionnet.base.errors import ModelError, TorsionnetWarning, UsageError
from torsionnet.io import read_tors, write_tors
from torsionnet.io.tors_reading import from_tors
from torsionnet.io.tors_writing import to_tors

# Assembly.from_tors(THRUSTER): sqrt(eigh(K, M)) / 2 pi; eigenvalues of its state matrix with positive imaginary part;
# first row of T inv(K - w^2 M + j w C) T^T with the gear transformation T = assembly.T(assembly.E()).
UNDAMPED = [17.9187362, 30.8116458, 71.2723227, 735.361989]
EIGENVALUES = [
    -5.95353636 + 112.47569909j,
    -3.84040892 + 193.5476995j,
    -18.72176813 + 447.17942879j,
    -0.17840988 + 4620.41399892j,
]
NODES = ["rotor", "hub", "wheel_1", "propeller_shaft_end", "propeller_disk", "wheel_2", "pump_disk"]
RECEPTANCE = {
    2.0: [
        -0.0029924277103261345 - 0.0009751941942073821j,
        -0.003057416012459292 - 0.0009680458462976546j,
        0.0012994018052951992 + 0.0004114194846765032j,
        0.0013056082511560363 + 0.0004096300163069864j,
        0.0013115051537416346 + 0.0004079125664791571j,
        0.0022598292266003462 + 0.0007155121472634838j,
        0.0022670776683479422 + 0.0007163035797809349j,
    ],
    40.0: [
        -1.8910147623361218e-05 - 7.001887360790031e-07j,
        -1.9061684914879382e-06 - 1.385175810136125e-07j,
        8.101216088823737e-07 + 5.8869971930785306e-08j,
        1.9554083471943458e-07 + 4.177125438229993e-09j,
        -3.93934021649817e-07 - 4.816561883993169e-08j,
        1.4089071458823891e-06 + 1.0238255987962662e-07j,
        -6.688554742532434e-06 - 1.6135536712619728e-06j,
    ],
}
# What openTorsion makes of the files written here of library models, without the rigid body, Hz.
WRITTEN = {
    "drill_string": [1.94166174, 4.07192091, 6.54374089, 9.15472684, 10.52439056],
    "geared_branch": [425.35947747, 634.07276002, 3247.19235372],
    "marine_steam_turbine": [2.96185253, 3.66960472, 21.37640928, 41.61445316, 48.05637302],
}


def disk(name, inertia=1.0, damping=0, **more):
    return {"name": name, "type": "Disk", "inertia": inertia, "damping": damping, **more}


def shaft(name, stiffness=1000.0, **more):
    return {"name": name, "type": "ShaftDiscrete", "stiffness": stiffness, "damping": 0, **more}


def file_of(*components, structure=()):
    listed = [{"name": name, "elements": list(elements)} for name, *elements in components]
    return {"name": "test", "components": listed, "structure": [list(pair) for pair in structure]}


def changed(path, value):
    data = copy.deepcopy(THRUSTER)
    place = data
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return data


class TestReading:
    def test_natural_frequencies_and_eigenvalues_of_opentorsion(self):
        modes = from_tors(THRUSTER).modes()
        np.testing.assert_allclose(modes.undamped_natural_frequencies[1:], UNDAMPED, rtol=1e-8)
        found = modes.eigenvalues[modes.eigenvalues.imag > 1]
        np.testing.assert_allclose(found, EIGENVALUES, rtol=1e-8)

    @pytest.mark.parametrize("frequency", RECEPTANCE)
    def test_frequency_response_of_opentorsion(self, frequency):
        values = from_tors(THRUSTER).frequency_response(NODES, "T_rotor", [frequency]).values
        np.testing.assert_allclose(values[0, :, 0], RECEPTANCE[frequency], rtol=1e-10)

    def test_two_disks_on_a_shaft(self):
        rig = from_tors(file_of(("line", disk("a", 2.0), shaft("k", 1500.0), disk("b", 3.0))))
        expected = np.sqrt(1500.0 * (1 / 2 + 1 / 3)) / (2 * np.pi)
        assert rig.modes().natural_frequencies[-1] == pytest.approx(expected, rel=1e-12)

    def test_names_values_and_inputs(self):
        rig = from_tors(THRUSTER)
        assert rig.name == "thruster"
        assert set(rig.nodes) == set(NODES)
        assert [rig.elements[name].node for name in ("rotor", "fan")] == ["rotor", "rotor"]
        assert rig.ratio_between("hub", "wheel_1") == pytest.approx(-40 / 17)
        assert {name: entry.to_data() for name, entry in rig.inputs.items()} == {"T_rotor": {"torque": "rotor"}}
        assert {"propeller_shaft", "pump_shaft", "pump_disk_damping"} <= set(rig.elements)
        assert rig.elements["tail"].to_data()["density"] == 7850
        assert rig.elements["propeller_shaft"].to_data()["density"] == 8000

    def test_model_file_is_the_same_model(self, tmp_path):
        (tmp_path / "t.tors").write_text(json.dumps(THRUSTER), encoding="utf-8")
        rig = read_tors(tmp_path / "t.tors")
        assert tn.loads(rig.to_yaml()) == rig

    def test_a_gear_by_diameters(self):
        wheels = [
            {"name": "p", "type": "GearElement", "inertia": 0, "diameter": 50.0},
            {"name": "w", "type": "GearElement", "inertia": 1, "diameter": 80.0, "parent": "p"},
        ]
        rig = from_tors(file_of(("box", disk("a"), *wheels)))
        assert rig.ratio_between("a", "w") == pytest.approx(-1.6)

    def test_keys_of_other_programs_are_passed_over(self):
        data = copy.deepcopy(THRUSTER)
        for place in (data, *data["components"], *data["components"][0]["elements"]):
            place |= {"position": [1, 2], "comment": None}
        data["components"][0]["elements"][1] |= {"node": 3, "stiffness": None}
        assert from_tors({**data, "date": 5}) == from_tors(THRUSTER)

    @pytest.mark.slow
    def test_long_chain(self):
        elements = [part for i in range(2000) for part in (disk(f"d{i}"), shaft(f"s{i}"))]
        assert len(from_tors(file_of(("line", *elements, disk("end")))).nodes) == 2001


class TestWhereOpenTorsionReadsOtherwise:
    def test_two_components_from_one_place(self):
        data = file_of(
            ("a", disk("x", 2.0)), ("b", shaft("s"), disk("y")), ("c", shaft("t"), disk("z")),
            structure=[("a.x", "b.s"), ("a.x", "c.t")],
        )  # fmt: skip
        with pytest.warns(TorsionnetWarning, match=r"^2 .* a\.x; openTorsion 0\.3\.2"):
            rig = from_tors(data)
        assert [rig.elements[name].nodes for name in ("s", "t")] == [("x", "y"), ("x", "z")]

    def test_a_chain_that_goes_on_after_a_branch(self):
        data = file_of(
            ("a", disk("x"), shaft("s"), disk("y")), ("b", shaft("t"), disk("z")), structure=[("a.x", "b.t")]
        )
        with pytest.warns(TorsionnetWarning, match=r"^a\.s follows a\.x"):
            rig = from_tors(data)
        assert rig.elements["s"].nodes == ("x", "y")

    def test_damping_of_a_continuous_shaft(self):
        continuous = {"name": "s", "type": "ShaftContinuous", "length": 1000.0, "outerDiameter": 50.0, "damping": 4.0}
        with pytest.warns(TorsionnetWarning, match="continuous shafts"):
            rig = from_tors(file_of(("a", disk("x"), continuous, disk("y"))))
        assert rig.elements["s"].to_data()["damping"] == 4

    def test_stiffness_of_a_disk_is_a_spring_to_ground(self):
        """One disk of 2 kg m^2 on 800 N m/rad: 20 rad/s."""
        data = file_of(("a", disk("x", 2.0, stiffness=800.0), shaft("s"), disk("y", 0.0)))
        with pytest.warns(TorsionnetWarning, match=r"^a\.x .* ground, .* disks"):
            rig = from_tors(data)
        assert rig.modes().natural_frequencies.max() == pytest.approx(20 / (2 * np.pi))


FAULTS = {
    "nothing": ({"components": [], "structure": []}, "components missing-entry"),
    "no list": ({"components": 3}, "wrong-file"),
    "type": (
        changed(["components", 0, "elements", 2, "type"], "ShaftDiscret"),
        "components.0.elements.2.type unknown-word",
    ),
    "list as type": (
        changed(["components", 0, "elements", 2, "type"], []),
        "components.0.elements.2.type unknown-word",
    ),
    "no name": (
        changed(["components", 3, "elements", 1], {"type": "Disk", "inertia": 1}),
        "components.3.elements.1 missing-entry",
    ),
    "number as parent": (
        changed(["components", 1, "elements", 1, "parent"], 3),
        "components.1.elements.1.parent wrong-form",
    ),
    "missing": (
        changed(["components", 0, "elements", 2], {"name": "c", "type": "ShaftDiscrete"}),
        "components.0.elements.2 missing-entry",
    ),
    "negative": (
        changed(["components", 0, "elements", 2, "stiffness"], -5),
        "components.0.elements.2.stiffness out-of-range",
    ),
    "text": (
        changed(["components", 0, "elements", 0, "inertia"], "1"),
        "components.0.elements.0.inertia not-a-number",
    ),
    "truth": (
        changed(["components", 0, "elements", 0, "inertia"], True),
        "components.0.elements.0.inertia not-a-number",
    ),
    "infinite": (
        changed(["components", 0, "elements", 0, "inertia"], float("inf")),
        "components.0.elements.0.inertia not-a-number",
    ),
    "parent": (
        changed(["components", 1, "elements", 1, "parent"], "pinoin"),
        "components.1.elements.1.parent unknown-element",
    ),
    "teeth": (
        changed(["components", 1, "elements", 0], {"name": "pinion", "type": "GearElement", "inertia": 1}),
        "components.1.elements.0 missing-entry",
    ),
    "hollow": (
        changed(["components", 2, "elements", 0, "innerDiameter"], 70.0),
        "components.2.elements.0 contradicting-values",
    ),
    "structure": (changed(["structure", 0, 1], "gearbox.pinon"), "structure.0.1 unknown-element"),
    "middle": (changed(["structure", 0, 1], "gearbox.wheel 1"), "structure.0.1 no-counterpart"),
    "loop": (changed(["structure", 2, 1], "propeller.shaft"), "structure.2.1 no-counterpart"),
    "apart": (changed(["structure"], THRUSTER["structure"][:2]), "structure unconnected-nodes"),
    "pair": (changed(["structure", 0], ["motor.hub"]), "structure.0 wrong-form"),
    "twice": (changed(["components", 0, "elements", 1, "name"], "rotor"), "components.0.elements.1 repeated-name"),
    "empty": (changed(["components", 0, "elements"], []), "components.0.elements missing-entry"),
}


class TestFaults:
    @pytest.mark.parametrize("name", FAULTS)
    def test_each_is_refused_at_its_place(self, name):
        data, place = FAULTS[name]
        assert placed_faults(lambda: from_tors(data, "f.tors")) == [place]

    def test_wheels_need_a_common_measure(self):
        wheels = [
            {"name": "p", "type": "GearElement", "inertia": 0, "diameter": 50.0},
            {"name": "w", "type": "GearElement", "inertia": 1, "teeth": 30, "parent": "p"},
        ]
        with pytest.raises(ModelError, match=r"components\.0\.elements\.2: .*missing-entry"):
            from_tors(file_of(("box", disk("a"), *wheels)))

    def test_all_at_once_with_their_places(self, tmp_path):
        data = changed(["components", 0, "elements", 2, "stiffness"], -5)
        data["components"][3]["elements"][1]["type"] = "Disc"
        text = json.dumps(data, indent=1)
        (tmp_path / "f.tors").write_text(text, encoding="utf-8")
        with pytest.raises(ModelError) as caught:
            read_tors(tmp_path / "f.tors")
        lines = text.splitlines()
        expected = [lines.index(next(line for line in lines if part in line)) + 1 for part in ("-5", '"Disc"')]
        assert [fault.position.line for fault in caught.value.faults] == expected

    def test_a_wrong_entry_has_no_other_faults_for_its_consequences(self):
        data = changed(["components", 0, "elements", 3, "inertia"], None)
        data["components"][2]["elements"][0]["innerDiameter"] = 70.0
        with pytest.raises(ModelError) as caught:
            from_tors(data, "f.tors")
        paths = [fault.path for fault in caught.value.faults]
        assert paths == [("components", 0, "elements", 3, "inertia"), ("components", 2, "elements", 0)]

    def test_no_json(self, tmp_path):
        (tmp_path / "f.tors").write_text('{"components": [\n}', encoding="utf-8")
        with pytest.raises(ModelError, match=r":2:1: .*wrong-file"):
            read_tors(tmp_path / "f.tors")

    @pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"[" * 100_000, b"null", b"{}", b"[1]"])
    def test_what_is_no_file_of_the_kind(self, tmp_path, content):
        (tmp_path / "f.tors").write_bytes(content)
        with pytest.raises(ModelError):
            read_tors(tmp_path / "f.tors")

    def test_no_file(self, tmp_path):
        with pytest.raises(UsageError, match="there is no file"):
            read_tors(tmp_path / "f.tors")


class TestWriting:
    @pytest.mark.parametrize("name", WRITTEN)
    def test_library_models_as_opentorsion_reads_them(self, name):
        data = json.loads(json.dumps(to_tors(tn.load(name))))
        read = frequencies_by_counting(data)
        np.testing.assert_allclose(read[1:], WRITTEN[name], rtol=1e-7)

    @pytest.mark.parametrize("seed", range(40))
    def test_random_trees_come_back_and_are_what_a_counting_reader_reads(self, seed):
        rig = random_tree(random.Random(seed), 2 + seed % 9)
        data = to_tors(rig)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            back = from_tors(data)
        nodes = [node for node in rig.nodes if "." not in node]
        ours, theirs = (model.frequency_response(nodes, "n0", [3.0, 20.0]).values for model in (rig, back))
        np.testing.assert_allclose(theirs, ours, rtol=1e-10)
        found = rig.modes().undamped_natural_frequencies
        np.testing.assert_allclose(frequencies_by_counting(data), found, atol=1e-6 * max(found.max(), 1))

    def test_rigid_couplings_join_nodes_and_parallel_parts_add_up(self):
        rig = tn.Drivetrain(
            "line",
            [
                tn.Inertia("a", node="a", inertia=1),
                tn.RigidCoupling("flange", nodes=("a", "b")),
                tn.Spring("s", nodes=("b", "c"), stiffness=100),
                tn.Spring("t", nodes=("c", "b"), stiffness=50, damping=2),
                tn.Inertia("c", node="c", inertia=2),
            ],
        )
        shafts = [item for item in to_tors(rig)["components"][0]["elements"] if item["type"] == "ShaftDiscrete"]
        assert [(item["stiffness"], item["damping"]) for item in shafts] == [(150, 2)]

    def test_file_is_text_that_reads_again(self, tmp_path):
        rig = tn.load("marine_steam_turbine")
        write_tors(rig, tmp_path / "t.tors")
        back = read_tors(tmp_path / "t.tors")
        np.testing.assert_allclose(back.modes().natural_frequencies, rig.modes().natural_frequencies, rtol=1e-12)
        assert set(back.nodes) == set(rig.nodes)

    def test_the_editor_finds_what_it_asks_for(self):
        """Texts for name and date, lists for the rest, a name and a type for every element."""
        data = to_tors(tn.load("marine_steam_turbine"))
        assert isinstance(data["name"], str)
        assert date.fromisoformat(data["date"])
        assert all(isinstance(end, str) for pair in data["structure"] for end in pair)
        elements = [element for component in data["components"] for element in component["elements"]]
        assert all(isinstance(element[key], str) for element in elements for key in ("name", "type"))

    @pytest.mark.parametrize(
        ("elements", "text"),
        [
            ([tn.Lock("l", node="a")], "l (lock), constraint a = 0;"),
            ([tn.Spring("s", nodes=("a", "ground"), stiffness=1)], "s (spring), stiffness on a;"),
            (
                [tn.HystereticSpring("h", nodes=("a", "b"), stiffness=1, loss_factor=0.1)],
                "h (hysteretic_spring), stiffness and loss factor on a - b;",
            ),
            ([tn.Gear("g", nodes=("a", "b"), ratio=2, stiffness=5)], "g (gear), stiffness on a - 2*b;"),
            ([tn.Gear("g", nodes=("a", "b"), ratio=2, housing="c")], "g (gear), constraint a - 2*b + c = 0;"),
            (
                [tn.Shaft("s", nodes=("a", "ground"), outer_diameter=0.05, length=1, segments=2, inertia="lumped")],
                "s (shaft), stiffness on s.1;",
            ),
            (
                [tn.Planetary("p", sun="a", ring="b", carrier="c", ratio=2)],
                "p (planetary), constraint a + 2*b - 3*c = 0;",
            ),
            ([tn.Clearance("c", nodes=("a", "b"), gap=1, stiffness=5)], "c (clearance) follow laws of motion"),
            ([EXPORTED["in series, one beside"]], "e closes a loop"),
            ([tn.Spring(f"s{a}{b}", nodes=(a, b), stiffness=1) for a, b in ("ab", "bc", "ca")], "sca closes a loop"),
            ([tn.Spring(f"s{b}", nodes=("a", b), stiffness=1) for b in "bcd"], "sc, sd lead on together from node a"),
        ],
    )
    def test_refusals_name_the_elements(self, elements, text):
        nodes = {node for element in elements for node in element.ports.values()} - {"ground"}
        masses = [tn.Inertia(f"j_{node}", node=node, inertia=1) for node in sorted(nodes)]
        with pytest.raises(UsageError) as caught:
            to_tors(tn.Drivetrain("x", [*masses, *elements]))
        assert text in str(caught.value)

    def test_what_a_configuration_takes_apart_is_no_tree(self):
        masses = [tn.Inertia(node, node=node, inertia=1) for node in "ab"]
        clutch = tn.RigidCoupling("clutch", nodes=("a", "b"), enabled=False)
        with pytest.raises(UsageError, match="no-counterpart"):
            to_tors(tn.Drivetrain("x", [*masses, clutch]))

    def test_negative_damping_is_written_for_opentorsion_and_not_read(self):
        load = tn.ConstantPowerLoad("load", node="a", power=200, speed=10)
        data = to_tors(tn.Drivetrain("x", [tn.Inertia("a", node="a", inertia=1), load]))
        assert data["components"][0]["elements"][1]["damping"] == -2
        with pytest.raises(ModelError, match=r"components\.0\.elements\.1\.damping: .*-2\.0.*out-of-range"):
            from_tors(data)

    def test_a_damper_alone_is_a_shaft_without_stiffness(self):
        masses = [tn.Inertia(node, node=node, inertia=1) for node in "ab"]
        data = to_tors(tn.Drivetrain("x", [*masses, tn.Damper("oil", nodes=("a", "b"), damping=3)]))
        assert data["components"][0]["elements"][1]["stiffness"] == 0
        assert from_tors(data).elements["oil"].to_data() == {"type": "damper", "nodes": ["a", "b"], "damping": 3}

    @pytest.mark.parametrize("case", sorted(EXPORTED.keys() - {"in series, one beside"}))
    def test_an_element_the_format_knows_nothing_of_is_written_by_its_parts_or_refused(self, case):
        element = EXPORTED[case]
        ports = dict.fromkeys(node for node in element.ports.values() if node != "ground")
        masses = [tn.Inertia(f"J_{node}", node=node, inertia=1 + place) for place, node in enumerate(ports)]
        rig = tn.Drivetrain("x", [element, *masses])
        if case in REFUSED:
            with pytest.raises(UsageError, match=rf" of e \({element.kind}\), ({REFUSED[case]})"):
                to_tors(rig)
            return
        back = from_tors(to_tors(rig))
        nodes = [node for node in ports if node in back.nodes]  # of nodes joined rigidly there is one
        ours, theirs = (model.frequency_response(nodes, nodes, [3.0, 20.0]).values for model in (rig, back))
        np.testing.assert_allclose(theirs, ours, rtol=1e-10)


REFUSED = {
    "to ground": "stiffness on a",
    "from ground": "stiffness on -a",
    "three ports": r"stiffness on a \+ b - 2\*c",
    "three, one on ground": r"stiffness on a \+ b",
    "inertia of a difference": "inertia and damping and stiffness on a - b",
    "all on three": r"inertia and damping and stiffness on 2\*a - 0.5\*b \+ 3\*c",
    "all on three, one on ground": r"inertia and damping and stiffness on 2\*a - 0.5\*b",
    "rigid, three": r"constraint 2\*a - 2\*b \+ 3\*c = 0",
    "rigid, two, one on ground": "constraint a = 0",
}


def frequencies_by_counting(data):
    """Undamped natural frequencies of a file read by counting nodes along the chains, as openTorsion does it.

    Its own small reader: no names of nodes, branches followed where they begin, wheels held together by multipliers.
    """
    parts = {part["name"]: part["elements"] for part in data["components"]}
    ends = {source: target.rpartition(".")[0] for source, target in data["structure"]}
    masses, springs, holds, wheels, last = [], [], [], {}, [0]

    def follow(name):
        for item in parts[name]:
            kind = item["type"]
            if kind == "Disk":
                masses.append((last[0], item["inertia"]))
            elif kind.startswith("Shaft"):
                k, m = item.get("stiffness"), 0.0
                if kind == "ShaftContinuous":
                    polar = np.pi * (item["outerDiameter"] ** 4 - item["innerDiameter"] ** 4) * 1e-12 / 32
                    k = 80e9 * polar / (item["length"] * 1e-3)
                    m = item.get("density", 8000) * polar * item["length"] * 1e-3 / 6
                springs.append((last[0], last[0] + 1, k, m))
                last[0] += 1
            else:
                size = item.get("teeth", item["diameter"])
                if "parent" in item:
                    last[0] += 1
                    place, other = wheels[f"{name}.{item['parent']}"]
                    holds.append(((place, other), (last[0], size)))
                masses.append((last[0], item["inertia"]))
                wheels[f"{name}.{item['name']}"] = (last[0], size)
            if f"{name}.{item['name']}" in ends:
                follow(ends[f"{name}.{item['name']}"])

    follow(next(name for name in parts if name not in ends.values()))
    n = last[0] + 1
    M, K = np.zeros((n, n)), np.zeros((n, n))
    for node, inertia in masses:
        M[node, node] += inertia
    for a, b, k, m in springs:
        K[np.ix_([a, b], [a, b])] += k * np.array([[1, -1], [-1, 1]])
        M[np.ix_([a, b], [a, b])] += m * np.array([[2, 1], [1, 2]])
    from scipy.linalg import eigh, null_space

    rows = np.zeros((len(holds), n))
    for row, ends_of in zip(rows, holds, strict=True):
        for node, size in ends_of:
            row[node] += size
    Z = null_space(rows) if holds else np.eye(n)
    return np.sqrt(np.abs(eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True))) / (2 * np.pi)
