"""Study files with faults: all of them at once, each at its place, and what is right instead."""

import re

import pytest

import torsionnet as tn
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.study import define
from torsionnet.study.quantities.expression import function

GOOD = """\
torsionnet: 1
model: amt_rig
configurations: [II, V]
vary:
  k_1: {type: normal, deviation: 4 %}
sampling: {count: 8}
quantities:
  z: {type: damping_ratio, mode: 1}
  f: {type: natural_frequency, mode: 1}
  r: {type: response, output: theta_1, input: T_M, at: 5 Hz}
"""


def raised(tmp_path, text):
    path = tmp_path / "plan.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ModelError) as caught:
        tn.load_study(path)
    return caught.value.faults


def faults(tmp_path, text):
    return [(fault.position.line, str(fault.text)) for fault in raised(tmp_path, text)]


def kinds(tmp_path, text):
    return [(fault.position.line, fault.kind) for fault in raised(tmp_path, text)]


def test_the_file_itself_is_right(tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(GOOD, encoding="utf-8")
    assert tn.load_study(path).count == 16


def test_all_faults_at_once(tmp_path):
    text = (
        GOOD.replace("[II, V]", "[II, VI]")
        .replace("k_1:", "k1:")
        .replace("count: 8", "count: 0")
        .replace("damping_ratio, mode: 1", "damping_ratio, mode: 9")
        .replace("theta_1", "theta_9")
        + "answers: {y: {type: yields}}\n"
    )
    found = faults(tmp_path, text)
    assert [line for line, _ in found] == [3, 5, 6, 8, 10, 11]
    said = " ".join(text for _, text in found)
    for words in ('"VI"', 'did you mean "k_1"', "expected a whole number", "theta_9", 'did you mean "yield"'):
        assert words in said


@pytest.mark.parametrize(
    ("limit", "kind"),
    [
        ("z: {above: 8 Hz}", "wrong-unit"),
        ("f: {below: 8 N*m}", "wrong-unit"),
        ("r: {below: 1 deg}", "wrong-unit"),
        ("q: {below: 1}", "unknown-name"),
        ("z: {below: 0.1, above: 0.2}", "contradicting-values"),
    ],
)
def test_limits(tmp_path, limit, kind):
    assert kinds(tmp_path, GOOD + f"limits:\n  {limit}\n") == [(12, kind)]


def test_limits_in_other_units_of_the_same_kind(tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(GOOD + "limits: {r: {below: 0.5 deg/(N*m)}, z: {above: 10 %}}\n", encoding="utf-8")
    limits = tn.load_study(path).limits
    assert limits["r"].below == pytest.approx(0.5 * 3.141592653589793 / 180)
    assert limits["z"].above == pytest.approx(0.1)


def test_targets_in_the_unit_of_their_quantity(tmp_path):
    text = GOOD + "answers:\n  best: {type: optimum, targets: {f: 8 N*m}}\n"
    [(line, said)] = faults(tmp_path, text)
    assert line == 12
    assert "f is in Hz" in said


def test_contradicting_correlations(tmp_path):
    text = GOOD.replace(
        "  k_1: {", "  c_1: {type: normal, deviation: 4 %}\n  c_B: {type: normal, deviation: 4 %}\n  k_1: {"
    )
    pairs = [("c_1", "c_B", 0.9), ("c_B", "k_1", 0.9), ("c_1", "k_1", -0.9)]
    lines = "".join(f"  - {{between: [{a}, {b}], coefficient: {size}}}\n" for a, b, size in pairs)
    found = faults(tmp_path, text + "correlation:\n" + lines)
    assert any("eigenvalue" in said for _, said in found)


def test_share_below_zero_is_said(tmp_path):
    [(line, said)] = faults(tmp_path, GOOD.replace("deviation: 4 %", "deviation: 60 %"))
    assert line == 5
    assert re.search(r"4\.8 % of k_1 .*low: 0", said)


def test_too_many_variants_are_refused_with_count_and_time():
    many = {"type": "range", "low": 400, "high": 500, "count": 1_000_000}
    wide = {"type": "range", "low": 10000, "high": 12000, "count": 1_000_000}
    study = tn.study.define(tn.load("amt_rig"), {"k_1": many, "k_2": wide}, {"z": {"type": "damping_ratio", "mode": 1}})
    with pytest.raises(UsageError, match=r"1e\+12 variants, about .* (days|years)"):
        tn.study.run_study(study)


@pytest.mark.parametrize("name", ["k_1", "configuration"])
def test_quantity_with_the_name_of_another_column(tmp_path, name):
    assert kinds(tmp_path, GOOD.replace("  z:", f"  {name}:")) == [(8, "repeated-name")]


def test_every_configuration_needs_its_weight(tmp_path):
    text = "limits: {z: {above: 0.1}}\nanswers: {y: {type: yield, weights: {II: 0.2}}}\n"
    assert kinds(tmp_path, GOOD + text) == [(12, "missing-entry")]


def test_study_without_quantities(tmp_path):
    ((_, text),) = faults(tmp_path, GOOD[: GOOD.index("quantities")])
    assert text.endswith("needs quantities: names and what is calculated, f_1: {type: natural_frequency, mode: 1}")


def test_sobol_indices_of_correlated_parameters_name_what_takes_them(tmp_path):
    text = GOOD.replace("sampling:", "  k_2: {type: normal, deviation: 3 %}\nsampling:") + (
        "correlation: [{between: [k_1, k_2], coefficient: 0.5}]\nanswers: {s: {type: sobol_indices}}\n"
    )
    ((_, said),) = faults(tmp_path, text)
    assert "rank correlations (type: scatter)" in said


@pytest.mark.parametrize("value", [1 + 2j, "x"])
def test_function_that_gives_no_real_number(value):
    quantity = function(lambda _: value)
    with pytest.raises(ModelError, match=r"quantities\.q: .*wrong-form"):
        define(tn.load("dmf_rig"), {"k_2": {"type": "list", "values": [460]}}, {"q": quantity})
