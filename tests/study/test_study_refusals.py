"""Studies that cannot be: what is said of them, the exit code, and that nothing in a folder is touched."""

import errno
import re
import sys
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from support.study_runs import contents, small_study

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import MissingExtraError, SolveError, UsageError
from torsionnet.study.answers.answer import ANSWERS, LIMIT, PARAMETER, QUANTITY, unknown_names
from torsionnet.study.quantities.expression import function
from torsionnet.study.quantities.quantity import QUANTITIES
from torsionnet.study.run import study_folder
from torsionnet.study.run.answering import Workers, answer_study
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.variations.variation import VARIATIONS
from torsionnet.study.study_file import quantity_model_faults

PLAN = """\
torsionnet: 1
model: amt_rig
configurations: [II, V]
vary:
  k_1: {type: normal, deviation: 4 %}
  k_2: {type: normal, deviation: 4 %}
  c_1: {type: normal, deviation: 4 %}
sampling: {count: 16}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  z: {type: damping_ratio, mode: 1}
"""


@pytest.fixture
def said(tmp_path):
    """What the command says of a plan, with the exit code that is expected."""

    def of(text, *words, code=1, command="study"):
        file = tmp_path / "plan.yaml"
        file.write_text(text)
        found = CliRunner().invoke(app, [command, str(file), *words])
        assert found.exit_code == code, found.output
        assert "Traceback" not in found.output
        return found.output

    return of


FAULTY = {
    "parameter": (PLAN.replace("k_1:", "k_l:"), "unknown-parameter"),
    "variation": (PLAN.replace("normal", "gaussian", 1), "unknown-word"),
    "correlation": (
        PLAN + "correlation:\n" + "".join(
            f"  - {{between: [{pair}], coefficient: {value}}}\n"
            for pair, value in (("k_1, k_2", 0.9), ("k_1, c_1", 0.9), ("c_1, k_2", -0.9))
        ),
        "contradicting-values",
    ),
    "below zero": (PLAN.replace("4 %", "60 %", 1), "out-of-range"),
    "unit of a value": (PLAN.replace("normal, deviation: 4 %", "uniform, low: 5 Hz, high: 9", 1), "wrong-unit"),
    "count": (PLAN.replace("16", "0"), "out-of-range"),
    "mode": (PLAN.replace("mode: 1", "mode: 99", 1), "unknown-mode"),
    "limit in Hz": (PLAN + "limits: {z: {below: 8 Hz}}\n", "wrong-unit"),
    "answer": (PLAN + "answers: {y: {type: yeild}}\n", "unknown-word"),
    "asked of nothing": (PLAN + "answers: {y: {type: scatter, quantities: [q]}}\n", "unknown-name"),
    "configuration": (PLAN.replace("[II, V]", "[II, X]"), "unknown-configuration"),
    "nameless quantity": (PLAN + "  '': {type: damping_ratio}\n", "invalid-name"),
    "damper without speeds": (
        PLAN + "answers: {d: {type: best_damper, output: theta_1, design: {c_1: [0.3, 6]}}}\n",
        "missing-entry",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTY)
def test_is_said_with_its_place(said, name):
    text, kind = FAULTY[name]
    found = said(text)
    assert f"[{kind}]" in found
    assert "plan.yaml:" in found
    assert "Nothing was calculated" in found


def test_all_faults_at_once(said):
    text = PLAN.replace("k_1:", "k_l:").replace("natural_frequency", "frequency").replace("16", "-1")
    found = said(text + "limits: {nix: {below: 1}}\nanswers: {y: {type: yeild}}\n")
    for words in ('"k_l"', '"frequency"', "got -1", '"nix"', '"yeild"'):
        assert words in found


def test_a_warning_is_said_once(said):
    found = said(PLAN.replace("count: 16", "method: sobol, count: 5"), code=0)
    assert found.count("powers of two") == 1


def test_study_given_for_a_model(said):
    found = said(PLAN, command="modes")
    assert re.search(r"plan\.yaml:4:1: .*wrong-file", found)
    assert "1 error" in found


def test_model_given_for_a_study(said):
    found = said((tn.library_models()["amt_rig"]).read_text())
    assert re.search(r"plan\.yaml:18:1: error: .*model: plan\.yaml.*wrong-file", found)
    assert "1 error" in found


@pytest.mark.parametrize(
    ("command", "name", "words"),
    [("modes", "amt_tolerances", "torsionnet study amt_tolerances"), ("study", "amt_rig", "model: amt_rig")],
)
def test_names_of_the_library_taken_for_another_kind(command, name, words):
    found = CliRunner().invoke(app, [command, name])
    assert found.exit_code == 2
    assert words in found.output


def test_another_study_touches_nothing(said, tmp_path):
    folder = tmp_path / "results"
    said(PLAN, "-o", str(folder), code=0)
    before = contents(folder)
    assert "sampling: count 16 -> 17" in said(PLAN.replace("16", "17"), "-o", str(folder), code=2).replace(
        "; the size of chunks is another", ""
    )
    assert contents(folder) == before


def test_disk_that_is_full_from_the_first_byte(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(study_folder, "write_text", full)
    with pytest.raises(SolveError, match="the disk is full"):
        run_study(small_study(10), tmp_path / "results")


def _times(factor):
    return lambda rig: factor * rig.modes().natural_frequencies[0]


def test_function_made_with_another_value_is_another():
    data = [function(_times(factor)).to_data() for factor in (2.0, 2.0, 3.0)]
    assert data[0] == data[1]
    assert data[0] != data[2]


def test_function_with_another_default_is_another():
    def made(factor):
        def scaled(rig, by=factor):
            return by * rig.modes().natural_frequencies[0]

        return function(scaled)

    assert made(2.0).to_data() == made(2.0).to_data() != made(3.0).to_data()


def test_what_is_not_drawn_beside_ranges_is_named(said):
    ranges = PLAN.replace("k_1: {type: normal, deviation: 4 %}", "k_1: {type: range, low: -5 %, high: +5 %, count: 3}")
    text = said(ranges.replace("sampling: {count: 16}\n", ""), code=2)
    assert "k_2, c_1 have distributions and are not drawn: give sampling" in text


def test_a_numba_that_refuses_this_numpy_is_done_without(monkeypatch):
    """As if there were none: its import says that another numpy is needed."""

    class Refusing:
        def find_spec(self, name, *_):
            if name.partition(".")[0] == "numba":
                raise ImportError("Numba needs NumPy 2.3 or less. Got NumPy 2.4.")

    for name in [
        one
        for one in sys.modules
        if one == "torsionnet.linear.dynamic_stiffness.compiled" or one.partition(".")[0] == "numba"
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Refusing(), *sys.meta_path])
    study = small_study(count=10**6)
    assert study.method == "graph"
    with pytest.raises(MissingExtraError, match="missing-package"):
        import torsionnet.linear.dynamic_stiffness.compiled  # noqa: F401


@pytest.mark.parametrize("processes", [61, 62])
def test_windows_waits_for_61_processes_at_most(monkeypatch, processes):
    assert Workers(62).processes == 62
    monkeypatch.setattr("torsionnet.study.run.answering.os", SimpleNamespace(name="nt"))
    if processes == 61:
        assert Workers(processes).processes == 61
    else:
        with pytest.raises(UsageError, match=r"(?s)61.*too-large"):
            Workers(processes)


def test_answers_of_variants_need_some_and_others_choose_their_own():
    answers = {"share": {"type": "yield"}, "moves": {"type": "tornado"}}
    study = small_study(sampling={"count": 8}, limits={"f_1": {"above": 1.0}}, answers=answers)
    counted = []
    found = answer_study(study, answering=lambda name, *_: counted.append(name))
    assert ({*counted}, {*found.conclusions}) == ({"moves"}, {"share", "moves"})
    undrawn = small_study(sampling=None, limits={"f_1": {"above": 1.0}}, answers=answers)
    with pytest.raises(UsageError, match="nothing-varies"):
        answer_study(undrawn)


SEED = 2**32 - 1
COUNTS = [
    (Samples, "count", 1, 10**15), (Samples, "seed", 0, SEED), (VARIATIONS["range"], "count", 2, 10**9),
    (QUANTITIES["band_mean"], "points", 2, 100_000), (QUANTITIES["response"], "points", 2, 100_000),
    (QUANTITIES["order_torque"], "every", 1, 10_000), (QUANTITIES["natural_frequency"], "mode", 1, 1000),
    (ANSWERS["map"], "points", 2, 1000), (ANSWERS["map"], "draws", 1, 100_000), (ANSWERS["map"], "seed", 0, SEED),
    (ANSWERS["worst_case"], "tried", 1, 10**9), (ANSWERS["worst_case"], "seed", 0, SEED),
    (ANSWERS["sobol_indices"], "seed", 0, SEED), (ANSWERS["failure_probability"], "seed", 0, SEED),
    (ANSWERS["parallel_coordinates"], "lines", 1, 10_000), (ANSWERS["optimum"], "seed", 0, 2**31 - 1),
    (ANSWERS["robust_optimum"], "samples", 2, 10**6), (ANSWERS["robust_optimum"], "compared", 2, 10**7),
    (ANSWERS["pareto"], "population", 4, 100_000), (ANSWERS["pareto"], "generations", 1, 100_000),
]  # fmt: skip
"""Whole numbers of a study file with the least that makes sense, such as both ends of an axis, and the most."""


@pytest.mark.parametrize(("cls", "entry", "least", "most"), COUNTS)
def test_whole_numbers_have_a_least_and_a_most(cls, entry, least, most):
    for number, wrong in ((least - 1, True), (least, False), (most, False), (most + 1, True)):
        told = [fault for fault in cls.read_entries({entry: number})[1] if fault.path == (entry,)]
        assert bool(told) is wrong, number


def test_names_are_listed_unless_they_are_the_parameters_of_a_model():
    wrong = {QUANTITY: "f1", PARAMETER: "k", LIMIT: "peak"}
    known = {QUANTITY: ["f_1", "z"], PARAMETER: ["k_1", "k_2"], LIMIT: []}
    faults = unknown_names({what: what for what in wrong}, wrong, known)
    assert [fault.message.partition(";")[0] for fault in faults] == [
        f'no {what} is named "{name}"' for what, name in wrong.items()
    ]
    assert ["there are" in fault.message for fault in faults] == [True, False, False]
    assert faults[0].message.endswith("there are f_1, z")


def test_configurations_are_named_where_others_are_right():
    shaft = tn.Spring("shaft", nodes=("a", "b"), stiffness=100)
    rig = tn.Drivetrain(
        "rig",
        [tn.Inertia("one", node="a", inertia=1), tn.Spring("seat", nodes=("a", "ground"), stiffness=9), shaft,
         tn.Inertia("two", node="b", inertia=1)],
        configurations={"whole": {}, "bare": {"off": ["shaft", "two"]}, "alone": {"off": ["shaft", "two"]}},
        inputs={"T_M": {"torque": "a"}},
    )  # fmt: skip
    quantities = {"T": QUANTITIES["response"](output="torque(shaft)", input="T_M", at=(1.0,))}
    assert not quantity_model_faults(rig, ["whole"], quantities)
    for configurations, named in ((["whole", "bare", "alone"], "bare, alone"), (["bare", "alone"], "")):
        (fault,) = quantity_model_faults(rig, configurations, quantities)
        assert (fault.path[:2], fault.configuration) == (("quantities", "T"), named)
