"""Many variants at once against each by itself."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.linear.assembly.law_stiffness import LawStiffness, law_stiffness
from torsionnet.linear.dynamic_stiffness import tape

F = np.array([0.0, 0.5, 4.0, 8.1, 30.0])
both = pytest.mark.parametrize("method", ["graph", "compiled"])


def one_by_one(rig, output, input, variants, **options):
    names = list(variants)
    copies = [rig.configured(**dict(zip(names, row, strict=True))) for row in zip(*variants.values(), strict=True)]
    return np.array([copy.frequency_response(output, input, F, method="dense", **options).values for copy in copies])


@both
@pytest.mark.parametrize(
    "variants",
    [
        {"c_O": [100.0, 170.0, 360.0], "c_1": [2.0, 4.0, 6.0]},
        {"tau": [3.26, 7.96, 7.96, 3.26], "k_1": [400.0, 460.0, 500.0, 520.0]},  # rows differ
        {"c_O": [0.0, 170.0]},  # a law drops out
    ],
)
@pytest.mark.parametrize("measured", ["T_T", "T_M"])
def test_variants_as_each_by_itself(variants, measured, method):
    rig = tn.load("amt_rig")
    outputs = ["theta_1", "twist(half_shaft)", "torque(gearbox, output_shaft)"]
    found = rig.frequency_responses(outputs, measured, F, variants, method=method)
    assert found.values == pytest.approx(one_by_one(rig, outputs, measured, variants), rel=1e-9, abs=1e-15)
    assert len(found) == len(next(iter(variants.values())))
    assert found[1].values == pytest.approx(found.values[1])
    assert (found.conditioning is None) == (measured == "T_M")


@both
def test_imposed_angle_and_frequency_dependent_laws(method):
    rig = tn.Drivetrain(
        "driven",
        [
            tn.HystereticSpring("rubber", nodes=("drive", "a"), stiffness="k", loss_factor="eta"),
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=500, damping=2),
            tn.Inertia("load", node="b", inertia=0.1),
        ],
        parameters={"k": 1e3, "eta": 0.1, "J": 0.2},
        inputs={"phi": {"angle": "drive"}},
    )
    variants = {"k": [900.0, 1e3, 1100.0], "eta": [0.05, 0.1, 0.3], "J": [0.1, 0.2, 0.5]}
    found = rig.frequency_responses(["a", "torque(shaft)"], "phi", F, variants, method=method)
    assert found.values == pytest.approx(one_by_one(rig, ["a", "torque(shaft)"], "phi", variants), rel=1e-9)


def test_one_value_holds_for_all_and_titles_tell_them_apart():
    family = tn.load("dmf_rig").frequency_responses("theta_1", "T_T", F, {"k_2": [400, 460], "c_2": 5})
    assert family.parameters["c_2"].tolist() == [5.0, 5.0]
    assert [H.title for H in family] == [f"DMF test rig, k_2 = {k}, c_2 = 5" for k in (400, 460)]
    assert repr(family) == "<FrequencyResponses theta_1 / T_T: 2 variants of k_2, c_2, 5 frequencies>"


def test_blocks_cut_variants_and_frequencies(monkeypatch):
    rig, variants = tn.load("dmf_rig"), {"k_2": np.linspace(300, 600, 7)}
    whole = rig.frequency_responses("theta_1", "T_T", F, variants).values
    for size in (2, 11):
        monkeypatch.setattr(tape, "FEWEST_POINTS", size)
        monkeypatch.setattr(tape, "MOST_POINTS", size)
        assert rig.frequency_responses("theta_1", "T_T", F, variants).values == pytest.approx(whole, rel=1e-13)


def test_blocks_hold_every_lane_once():
    system = tn.load("dmf_rig").assembly.system
    kappa = law_stiffness([system] * 3, np.arange(10.0))
    for size in (1, 4, 10, 25, 100):
        blocks = list(kappa.blocks(size))
        assert max(block.n_points for block in blocks) <= max(size, 1)
        assert np.array_equal(np.concatenate([block.by_law for block in blocks], axis=1), kappa.by_law)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("own_frequencies", [False, True])
def test_points_chosen_of_variants_keep_their_laws_and_actions(count, own_frequencies):
    random = np.random.default_rng(0)
    omega = 1 + random.random((count, 4)) if own_frequencies else 1 + random.random(4)
    samples, gains = random.random((count, 4)) + 2j, random.random((count, 4)) - 1j
    kappa = LawStiffness(*random.random((3, count, 5)), omega, ((2, samples),), (gains,))
    points = np.array([0, 2, 4 * count - 1])
    chosen = kappa.at(points)
    np.testing.assert_allclose(chosen.by_law, kappa.by_law[:, points], rtol=1e-15)
    assert np.array_equal(chosen.s, kappa.s[points])
    assert np.array_equal(chosen.actions[0].ravel(), gains.ravel()[points])
    factors = np.arange(1.0, 6.0)
    np.testing.assert_allclose(chosen.scaled(factors).by_law, factors[:, None] * chosen.by_law, rtol=1e-15)


@pytest.mark.parametrize(
    ("variants", "message"),
    [
        ({"k_3": [1.0]}, "unknown-parameter"),
        ({"k_2": [1.0, 2.0], "c_2": [1.0, 2.0, 3.0]}, "all of one length"),
        ({"k_2": ["soft"]}, "wrong-form"),
        ({"k_2": []}, "wrong-form"),
        ({}, "wrong-form"),
    ],
)
def test_variants_that_make_no_sense(variants, message):
    with pytest.raises(tn.UsageError, match=message):
        tn.load("dmf_rig").frequency_responses("theta_1", "T_T", F, variants)


def test_impossible_value_is_refused():
    with pytest.raises(tn.ModelError, match="k_2"):
        tn.load("dmf_rig").frequency_responses("theta_1", "T_T", F, {"k_2": [400.0, -1.0]})


def test_compiled_without_numba_names_the_command(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "torsionnet.linear.dynamic_stiffness.compiled", raising=False)
    monkeypatch.delattr("torsionnet.linear.dynamic_stiffness.compiled", raising=False)
    with pytest.raises(tn.MissingExtraError, match=r'pip install "torsionnet\[fast\]"'):
        tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1.0], method="compiled")
