"""Responses of batches against each variant by itself, solved densely in LAPACK or by its own model."""

import tracemalloc

import numpy as np
import pytest
from support.batches import batch_of
from support.library_cases import library_cases
from support.models import EVERY_ELEMENT, around

import torsionnet as tn
from torsionnet.linear.batch import batched_responses as module
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_responses import batched_responses
from torsionnet.linear.dynamic_stiffness import quotient
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request, usable_channels
from torsionnet.linear.responses import transfer
from torsionnet.model.model import Model

F = np.array([0.31, 2.2, 17.0, 91.0])
methods = pytest.mark.parametrize("method", ["graph", "compiled"])


def one_by_one(batch, output, input, f, excitation=None, method="auto"):
    """NaN where a variant is impossible."""
    found = []
    for index in range(len(batch)):
        try:
            found.append(
                batch.model(index).frequency_response(output, input, f, driven_by=excitation, method=method).values
            )
        except tn.ModelError:
            found.append(None)
    shape = next(one.shape for one in found if one is not None)
    return np.array([np.full(shape, np.nan) if one is None else one for one in found])


def together(batch, output, input, f, excitation=None, method="auto"):
    request = cached_request(batch.drivetrain, output, input, excitation)
    return batched_responses(batch, request, f, method).values


@pytest.mark.few(4, 8)
@pytest.mark.filterwarnings("ignore::torsionnet.TorsionnetWarning")
@methods
@pytest.mark.parametrize("name", library_cases())
def test_library_models(name, method):
    rig, rng = tn.load(name), np.random.default_rng(3)
    inputs, outputs = usable_channels(rig)
    planned = [one for one in rig.parameters if batch_plan(rig, [one]) is not None]
    batch = batch_of(rig, {one: rig.parameters[one] * rng.uniform(0.9, 1.1, 5) for one in planned})
    assert len(batch.stacked) >= 3
    outputs = [*outputs[:4], rig.nodes[-1]]
    found = together(batch, outputs, inputs[:1], F, method=method)
    expected = one_by_one(batch, outputs, inputs[:1], F)
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-13 * np.nanmax(np.abs(expected)))


@pytest.mark.few(4)
@methods
@pytest.mark.parametrize(
    ("input", "excitation"),
    [("T_T", None), (["T_T", "theta_1"], ["T_M", "input_shaft"]), (["T_M", "input_shaft"], None), ("theta_1", "T_M")],
)
def test_measured_inputs_and_several_excitations(input, excitation, method):
    rig, rng = tn.load("amt_rig").configured("IV"), np.random.default_rng(1)
    names = ["k_1", "k_2", "c_1", "c_O", "I_1", "I_2"]
    batch = batch_of(rig, {name: rig.parameters[name] * rng.normal(1, 0.1, 7) for name in names})
    outputs = ["theta_1", "twist(half_shaft)", "torque(dmf)", "velocity(motor)", "acceleration(hub)"][:4]
    found = together(batch, outputs, input, F, excitation, method)
    assert found == pytest.approx(one_by_one(batch, outputs, input, F, excitation, "dense"), rel=1e-10, abs=1e-14)


@pytest.mark.filterwarnings("ignore:the response is infinite at 0 Hz")
@methods
def test_special_variants(method):
    rig = tn.load("amt_rig").configured("V")
    values = {
        "k_1": [460.0, 0.0, -1.0, 500.0, np.nan],
        "c_1": [4.0, 4.0, 4.0, 0.0, 1.0],
        "c_O": [0.0, 1.0, 1.0, 170.0, 2.0],
    }
    batch = batch_of(rig, values)
    assert batch.separate.tolist() == [True, True, False, False, False]
    assert batch.impossible.tolist() == [False, False, True, False, True]
    f = np.array([0.0, *F])
    found = together(batch, ["theta_1", "T_T"], "T_M", f, method=method)
    expected = one_by_one(batch, ["theta_1", "T_T"], "T_M", f)
    assert found == pytest.approx(expected, rel=1e-12, nan_ok=True)
    assert np.isnan(found).all(axis=(1, 2, 3)).tolist() == batch.impossible.tolist()


@methods
@pytest.mark.parametrize("kind", ["continuous_shaft", "hysteretic_spring", "controller", "fluid_coupling"])
def test_stiffness_over_frequency_and_actions(kind, method):
    model = around(EVERY_ELEMENT[kind])
    parts = [one for one in model.elements.values() if one.name not in ("j_x", "s_x", "e")]
    element = EVERY_ELEMENT[kind]
    parameters = {"J": 0.7, "k": 70.0, "eta": 0.2}
    if kind == "hysteretic_spring":
        element = tn.HystereticSpring("e", nodes=("a", "b"), stiffness="2*k", loss_factor="eta", damping=1)
    if kind == "continuous_shaft":
        element = tn.ContinuousShaft("e", nodes=("a", "b"), outer_diameter="eta", length=2, loss_factor="eta/9")
    parts += [tn.Inertia("j_x", node="x", inertia="J"), tn.Spring("s_x", nodes=("x", "a"), stiffness="k", damping=2)]
    rig = tn.Drivetrain("c", [*parts, element], parameters=parameters, inputs={"T": {"torque": "x"}})
    batch = batch_of(rig, {"J": [0.5, 0.7, 1.0], "k": [50.0, 70.0, 80.0], "eta": [0.1, 0.2, 0.3]})
    assert len(batch.stacked) == 3
    found = together(batch, ["a", "torque(e)"], "T", F, method=method)
    assert found == pytest.approx(one_by_one(batch, ["a", "torque(e)"], "T", F, method="dense"), rel=1e-9)


@methods
def test_stresses_of_sections_that_vary(method):
    rig = tn.Drivetrain(
        "stressed",
        [
            tn.Inertia("left", node="a", inertia=2),
            tn.Shaft("shaft", nodes=("a", "b"), outer_diameter="D", inner_diameter="D/3", length=0.8),
            tn.Inertia("right", node="b", inertia="J"),
        ],
        parameters={"D": 0.1, "J": 3},
        inputs={"T": {"torque": "a"}},
        sensors={"tau": {"stress": "shaft"}},
    )
    batch = batch_of(rig, {"D": [0.08, 0.1, 0.13], "J": [3.0, 4.0, 2.0]})
    for asked in (("tau", "T", F, None), ("b", "tau", F, "T"), (["tau", "a"], "tau", F, "T")):
        assert together(batch, *asked, method) == pytest.approx(one_by_one(batch, *asked), rel=1e-11)


@methods
def test_rigid_motion_at_rest(method):
    rig = tn.Drivetrain(
        "free",
        [
            tn.Inertia("left", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=900, damping=1),
            tn.Inertia("right", node="b", inertia=2),
        ],
        parameters={"J": 3},
        inputs={"T": {"torque": "a"}},
        sensors={"turned": {"angle": "a"}},
    )
    batch, f = batch_of(rig, {"J": [1.0, 6.0]}), np.array([0.0, 1.0])
    found = together(batch, ["b", "torque(shaft)"], "turned", f, "T", method)
    assert found[:, 0, 0, 0] == pytest.approx([1.0, 1.0])  # they turn as one
    single = one_by_one(batch, ["b", "torque(shaft)"], "turned", f, "T")
    assert found == pytest.approx(single, rel=1e-12, abs=1e-30)


@methods
def test_undamped_resonances_are_settled_by_single_models(method):
    """m = 1, k = (2 pi 5)^2: H = 1/(k - omega^2), next to the resonance in many digits."""
    import mpmath

    rig = tn.Drivetrain(
        "one mass",
        [tn.Inertia("mass", node="a", inertia="J"), tn.Spring("spring", nodes=("a", "ground"), stiffness="k")],
        parameters={"J": 1, "k": 900},
        inputs={"T": {"torque": "a"}},
    )
    k = np.array([900.0, (2 * np.pi * 5) ** 2, 800.0])
    batch = batch_of(rig, {"k": k})
    made, model = [], type(batch).model
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(batch), "model", lambda own, at: made.append(own.values["k"][at]) or model(own, at))
        found = together(batch, "a", "T", np.array([4.9, 5.0]), method=method)[:, :, 0, 0]
    assert set(made) == {k[1]}
    for row, stiffness in zip(found, k, strict=True):
        for value, f in zip(row, (4.9, 5.0), strict=True):
            with mpmath.workdps(60):
                exact = 1 / (mpmath.mpf(repr(float(stiffness))) - (2 * mpmath.pi * mpmath.mpf(f)) ** 2)
                assert abs(mpmath.mpc(value) / exact - 1) < 1e-9


def test_blocks_do_not_matter(monkeypatch):
    rig, rng = tn.load("amt_rig").configured("V"), np.random.default_rng(2)
    batch = batch_of(rig, {"k_1": rng.uniform(300, 600, 23), "c_O": rng.uniform(0, 300, 23)})
    whole = together(batch, "theta_1", "T_T", F)
    monkeypatch.setattr(module, "POINTS_AT_ONCE", 9)
    np.testing.assert_allclose(together(batch, "theta_1", "T_T", F), whole, rtol=1e-13)


@methods
def test_no_model_and_little_memory(monkeypatch, method):
    """What is needed beside the result does not grow with the variants."""
    rig, rng = tn.load("amt_rig").configured("V"), np.random.default_rng(2)
    plan = batch_plan(rig, ["k_1", "c_O"])
    batch = plan.batch({"k_1": rng.uniform(300, 600, 4000), "c_O": rng.uniform(100, 300, 4000)})
    together(batch.part(slice(1)), "theta_1", "T_T", F, method=method)
    f, made = np.linspace(1, 40, 200), []
    monkeypatch.setattr(Model, "_changed", lambda *_: made.append(1))
    tracemalloc.start()
    found = together(batch, "theta_1", "T_T", f, method=method)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert not made
    assert peak - found.nbytes - found.nbytes / 2 < 30e6


@methods
def test_a_variant_that_cannot_be_asked(method):
    """Without its spring the load feels nothing of the motor; the others are as if it were not there."""
    rig = tn.Drivetrain(
        "two masses",
        [
            tn.Inertia("left", node="a", inertia=2),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k"),
            tn.Inertia("right", node="b", inertia=3),
        ],
        parameters={"k": 900},
        inputs={"T": {"torque": "a"}},
        sensors={"turned": {"angle": "b"}},
    )
    batch, said = batch_of(rig, {"k": [800.0, 0.0, 900.0]}), []
    request = cached_request(rig, "a", "turned", None)
    found = batched_responses(batch, request, F, method, said.append)
    assert [one.kind for one in said] == ["zero-reading"]
    assert np.isnan(found.values[1]).all()
    omega = 2 * np.pi * F
    for index in (0, 2):  # k (a - b) = -3 w^2 b
        assert found.values[index, :, 0, 0] == pytest.approx(1 - 3 * omega**2 / batch.values["k"][index], rel=1e-12)
    with pytest.raises(tn.UsageError, match="stays zero"):
        batched_responses(batch, request, F, method)


@pytest.mark.parametrize("changes", [{}, {"k_1": 0.0}])
def test_variants_of_a_call_make_no_models(monkeypatch, changes):
    """Where a variant has other acting laws it alone is made."""
    rig, made = tn.load("amt_rig").configured("V"), []
    variants = {"k_1": [400.0, 460.0, changes.get("k_1", 480.0)], "c_O": [100.0, 120.0, 300.0]}
    expected = one_by_one(batch_of(rig, variants), "theta_1", "T_T", F)
    changed = Model._changed
    monkeypatch.setattr(Model, "_changed", lambda *args: made.append(1) or changed(*args))
    found = rig.frequency_responses("theta_1", "T_T", F, variants).values
    assert found == pytest.approx(expected, rel=1e-12)
    assert len(made) == 1 + 2 * bool(changes)


def test_compiled_and_numpy_agree_where_both_are_certain():
    rig = tn.load("dmf_rig")
    request = cached_request(rig, "theta_1", "T_T", None)
    batch = batch_of(rig, {"k_2": np.linspace(300, 600, 5), "c_2": np.zeros(5)})
    kappa = batch.law_stiffness(2 * np.pi * np.linspace(0.01, 40, 3000))
    compiled, numpy = (quotient.transfer_functions(request, kappa, method) for method in ("compiled", "graph"))
    np.testing.assert_allclose(compiled.values, numpy.values, rtol=1e-10)
    np.testing.assert_allclose(compiled.conditioning, numpy.conditioning, rtol=1e-10)
    doubts = [
        quotient.uncertain_points(
            quotient.rounding_errors(transfer.evaluation(request, method), kappa, found.values), 5
        )
        for method, found in (("compiled", compiled), ("graph", numpy))
    ]
    assert [marked.mean() < 0.01 for marked in doubts] == [True, True]
