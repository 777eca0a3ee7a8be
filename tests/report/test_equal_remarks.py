"""What holds of several limits or configurations in the same words stands in one line that names them."""

import copy
import json
import re

import numpy as np
import pytest
from support.command_line import run
from support.written_models import TWO_CYLINDER_PLANT

import torsionnet as tn
from torsionnet.base.equal_remarks import configurations_in_words, grouped_remarks
from torsionnet.machinery.verdicts.limit_checking import MISFIRING
from torsionnet.report.document_tree import Listing
from torsionnet.report.report import make_report

CONDITIONS = [
    f"rubber={rubber},firing={firing}" for rubber in ("cold", "warm") for firing in ("normal", "first", "each")
]


@pytest.fixture(scope="module")
def model():
    """Two unlike cylinders and two limits of one spring, so that both say the same of it."""
    data = copy.deepcopy(TWO_CYLINDER_PLANT)
    data["elements"] |= {
        "link": {"type": "spring", "nodes": ["crank", "c2"], "stiffness": "5 MN*m/rad"},
        "disc": {"type": "inertia", "node": "c2", "inertia": 50},
    }
    data["speeds"] = {"of": "crank", "list": ["500 rpm", "600 rpm"], "rated": "600 rpm"}
    data["excitations"]["engine"] |= {"cylinders": {"1": "crank", "2": "c2"}, "misfire": []}
    data["limits"]["spare"] = data["limits"]["rubber"]
    data["sensors"] = {"T": {"torque": "rubber"}}
    data["parameters"] = {"k": "2 MN*m/rad"}
    data["elements"]["rubber"]["stiffness"] = "k"
    data["configurations"] = {
        "rubber": {"cold": {}, "warm": {"k": "1.9 MN*m/rad"}},
        "firing": {"normal": {}, "first": {"engine.misfire": [1]}, "each": {"engine.misfire": "each"}},
    }
    return data


@pytest.fixture
def file(model, tmp_path):
    path = tmp_path / "plant.json"
    path.write_text(json.dumps(model), encoding="utf-8")
    return path


class TestLimits:
    def lines(self, file, *more, code=0):
        return run("limits", file, *more, code=code).stdout.splitlines()

    def test_a_misfire_is_told_once_with_the_configurations_that_have_it(self, file):
        shown = self.lines(file, "-c", "all")
        assert [line for line in shown if MISFIRING in line] == [f"firing=first or each: {MISFIRING}"]
        details = shown[shown.index("plant: limits") :]
        notes = [line for line in details if line.strip() and not line.startswith("rubber=")]
        assert len(set(notes)) == len(notes)

    def test_what_all_have_names_none(self, file):
        shown = self.lines(file, "-c", "firing=first", "-c", "firing=each", code=6)
        assert [line for line in shown if MISFIRING in line] == [MISFIRING]

    def test_worst_cylinders_stand_with_every_limit_they_are_the_worst_of(self, file, model):
        rig = tn.loads(json.dumps(model))
        for rubber in ("cold", "warm"):
            name = f"rubber={rubber},firing=each"
            check = rig.configured(name).check_limits()
            (remark,) = check.of("rubber", "T_KW").remarks
            assert re.fullmatch(r"worst at \d+ rpm: misfire of cylinder [12]", remark)
            assert check.of("spare", "T_KW").remarks == (remark,)
            assert [note for note in check.table().notes if remark in note] == [f"rubber, T_KW; spare, T_KW: {remark}"]
        said = [line for line in self.lines(file, "-c", "all") if "misfire of cylinder" in line]
        assert len(said) == len(set(said)) <= 2
        assert all("rubber, T_KW; spare, T_KW: " in line for line in said)

    def test_data_keep_the_remarks_of_each(self, file):
        data = json.loads(run("limits", file, "-c", "all", "--json").stdout)
        assert [MISFIRING in one["notes"] for one in data] == ["normal" not in name for name in CONDITIONS]

    def test_a_report_says_it_once_for_all_limits(self, model):
        report = make_report(tn.loads(json.dumps(model)), sections=["limits"], date=None)
        listings = [block for block in report.sections[0].blocks if isinstance(block, Listing)]
        said = [
            "".join(map(str, item)) for item in listings[-1].items if "misfire of cylinder" in "".join(map(str, item))
        ]
        assert said
        assert len({line.partition(" (in ")[0] for line in said}) == len(said)
        assert all(line.count("T") >= 2 and "each" in line for line in said)


def test_every_remark_is_told_of_all_that_it_was_said_of_and_of_no_other():
    rng = np.random.default_rng(1)
    said = [("abc"[i], CONDITIONS[j], "xy"[k]) for i, j, k in rng.integers((3, 6, 2), size=(40, 3))]
    found = [(about, name, text) for abouts, names, text in grouped_remarks(said) for about in abouts for name in names]
    assert len(found) == len(set(found))
    assert set(found) == set(said)


def test_names_in_words_mean_the_same_configurations():
    """Every choice of the six but none and all, read back by axes."""
    choices = {name: dict(part.split("=") for part in name.split(",")) for name in CONDITIONS}
    for chosen in range(1, 63):
        names = {name for place, name in enumerate(CONDITIONS) if chosen >> place & 1}
        words = configurations_in_words(sorted(names), CONDITIONS)
        meant = set()
        for group in words.removeprefix("all but ").split(", "):
            held = {axis: kept.split(" or ") for axis, kept in (part.split("=") for part in group.split(","))}
            meant |= {name for name, one in choices.items() if all(one[axis] in kept for axis, kept in held.items())}
        assert (set(CONDITIONS) - meant if words.startswith("all but ") else meant) == names, words
