"""One fault in a study file hides no other: each is told with its line and column."""

import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError

GOOD = """\
torsionnet: 1
model: amt_rig
vary:
  k_1: {type: normal, deviation: 4 %}
  c_1: {type: normal, deviation: 4 %}
  k_2: {type: range, low: 4 kN*m/rad, high: 30 kN*m/rad, count: 3}
sampling: {count: 8}
quantities:
  z: {type: damping_ratio, mode: 1}
  f: {type: natural_frequency, mode: 1}
  r: {type: response, output: theta_1, input: T_M, band: 1..5 Hz}
  q: {type: expression, of: f/z}
limits:
  f: {above: 5 Hz}
answers:
  map: {type: map, x: k_1, y: k_2, quantity: f}
  cloud: {type: scatter, quantities: [z, f]}
  best: {type: optimum, targets: {f: 8 Hz}, design: {k_1: [100 N*m/rad, 800 N*m/rad]}}
"""
NOT_A_COUNT = ("mode: 1}\n  f", "mode: x}\n  f")
"""A quantity that cannot be read, in line 9."""
NO_TYPE = ("type: scatter", "type: scater")
"""An answer that cannot be read, in line 17."""


def faults(tmp_path, *changes):
    """Line and text of what is marked."""
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "plan.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ModelError) as caught:
        tn.load_study(path)
    lines = text.splitlines()
    found = [(one.position.line, one.position.column, one.position.end_column) for one in caught.value.faults]
    return [(line, lines[line - 1][start - 1 : end - 1]) for line, start, end in found]


def test_the_file_itself_is_right(tmp_path):
    (tmp_path / "plan.yaml").write_text(GOOD, encoding="utf-8")
    assert tn.load_study(tmp_path / "plan.yaml").count == 24


@pytest.mark.few(4)
@pytest.mark.parametrize(
    "other",
    [NOT_A_COUNT, NO_TYPE, ("c_1: {type", "c1: {type"), ("deviation: 4 %}\n  k_2", "deviation: -4 %}\n  k_2")],
    ids=["quantity", "answer", "unknown parameter", "distribution"],
)
@pytest.mark.parametrize(
    ("change", "line", "marked"),
    [
        (("quantity: f}", "quantity: g}"), 16, "g"),
        (("quantity: f}", "quantity: r}"), 16, "r"),
        (("y: k_2", "y: k_9"), 16, "k_9"),
        (("targets: {f: 8 Hz}", "targets: {f: 8 N*m}"), 18, "8 N*m"),
        (("targets: {f: 8 Hz}", "targets: {g: 8 Hz}"), 18, "g"),
        (("design: {k_1", "design: {k_11"), 18, "k_11"),
        (("100 N*m/rad, 8", "100 Hz, 8"), 18, "k_1"),
        (("above: 5 Hz", "above: 5 N*m"), 14, "5 N*m"),
        (("  f: {above", "  g: {above"), 14, "g"),
        (("of: f/z", "of: f/x"), 12, "f/x"),
    ],
)
def test_what_is_wrong_elsewhere_is_told_too(tmp_path, other, change, line, marked):
    alone = faults(tmp_path, change)
    assert alone == [(line, marked)]
    assert sorted(faults(tmp_path, other, change)) == sorted([*alone, *faults(tmp_path, other)])


def test_what_an_answer_lacks_is_told_of_a_study_that_is_right_otherwise(tmp_path):
    """A yield needs limits; those of this file may be what cannot be read. An entry that names a curve is told always."""
    lacking = ("  best:", "  y: {type: yield}\n  best:")
    no_limits = ("limits:\n  f: {above: 5 Hz}\n", "")
    curve = ("quantity: f}", "quantity: r}")
    assert faults(tmp_path, lacking, no_limits) == [(16, "y")]
    assert faults(tmp_path, lacking, no_limits, NOT_A_COUNT) == [(9, "x")]
    assert faults(tmp_path, curve, NOT_A_COUNT) == [(9, "x"), (16, "r")]


def test_names_beside_a_wrong_entry_of_the_same_answer(tmp_path):
    change = ("y: k_2, quantity: f}", "y: k_9, quantity: g, points: many}")
    assert faults(tmp_path, change) == [(16, "k_9"), (16, "g"), (16, "many")]


def test_what_has_a_fault_itself_is_not_called_unknown(tmp_path):
    """The map asks for f and the expression is made of z, neither of which can be read."""
    far = ("f: {type: natural_frequency, mode: 1}", "f: {type: natural_frequency, mode: 99}")
    assert faults(tmp_path, NOT_A_COUNT, far) == [(9, "x"), (10, "99")]


def test_all_at_once(tmp_path):
    found = faults(
        tmp_path, NOT_A_COUNT, NO_TYPE, ("c_1: {type", "c1: {type"), ("y: k_2", "y: k_3"), ("{f: 8", "{g: 8"),
        ("  f: {above", "  g: {above"),
    )  # fmt: skip
    assert found == [(5, "c1"), (9, "x"), (14, "g"), (16, "k_3"), (17, "scater"), (18, "g")]


def test_correlations_beside_a_parameter_that_cannot_be_read(tmp_path):
    pair = "correlation: [{between: [k_1, c_1], coefficient: 0.5}, {between: [k_1, c_2], coefficient: 0.5}]\nsampling:"
    found = faults(tmp_path, ("sampling:", pair), ("c_1: {type: normal, deviation: 4 %}", "c_1: {type: normal}"))
    assert found == [(5, "c_1"), (7, "c_2")]


def test_expressions_of_expressions_of_nothing(tmp_path):
    found = faults(tmp_path, ("of: f/z}", "of: f/x}\n  p: {type: expression, of: 2*q}"))
    assert found == [(12, "f/x")]


def test_in_python():
    with pytest.raises(ModelError) as caught:
        tn.study.define(
            tn.load("amt_rig"),
            {"k_1": {"type": "normal", "deviation": "4 %"}},
            {"f": {"type": "natural_frequency", "mode": 1.5}},
            answers={"m": {"type": "map", "x": "k_1", "y": "k_9", "quantity": "f"}},
        )
    assert [fault.path for fault in caught.value.faults] == [("quantities", "f", "mode"), ("answers", "m", "y")]


@pytest.mark.parametrize(("method", "count"), [("importance", 3999), ("subset", 205)])
def test_counts_that_a_method_refuses_are_told_before_anything_is_calculated(tmp_path, method, count):
    rare = f"answers:\n  rare: {{type: failure_probability, method: {method}, count: {count}}}"
    assert faults(tmp_path, ("answers:", rare)) == [(16, str(count))]
