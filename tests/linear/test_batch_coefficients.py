"""Coefficients of many variants against each variant made by itself."""

import numpy as np
import pytest
from support.batches import batch_of, drawn, require_like_single_models
from support.library_cases import library_cases
from support.models import EVERY_ELEMENT, around

import torsionnet as tn
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.model.elements import ELEMENT_TYPES, make_element
from torsionnet.model.model import Model

SHEETS = {"mass_elastic"}
"""Types that are a short way of writing others."""
PLAIN = {"differential", "lock", "lumped_matrices", "rigid_coupling", "tabulated_spring"}
"""Types without a number that could be a parameter."""
SILICONE = {
    "moduli": [[1, 3e3, 9e3], [100, 6e4, 7e4]],
    "reference_temperature": "25 degC",
    "shift": {"25 degC": 1, "75 degC": 0.4},
}
GAP = {"outer_diameter": "400 mm", "inner_diameter": "250 mm", "axial_gap": "0.5 mm"}
MORE = {
    "a scaled table": tn.ViscousDamper("e", node="a", ring_inertia=3, table=[[1, 300, 2], [9, 500, 1]], scale=1.5),
    "a scaled silicone": tn.ViscousDamper(
        "e", node="a", ring_inertia=2, silicone=SILICONE, gap=GAP, temperature="75 degC", scale=2
    ),
    "damping by decrement": tn.Spring(
        "e", nodes=("a", "b"), stiffness=300, damping={"log_decrement": 0.3, "at": "9 Hz"}
    ),
    "damping by Q": tn.Spring("e", nodes=("a", "b"), stiffness=300, damping={"Q": 20, "at": "9 Hz"}),
    "loss by psi": tn.HystereticSpring("e", nodes=("a", "b"), stiffness=300, loss_factor={"psi": 0.9}),
    "curves": tn.FlexibleCoupling(
        "e", nodes=("a", "b"), stiffness=700, T_KN=100, torque=60, vibratory_torque=20,
        torque_factor={0.25: 0.9, 0.5: 1.2, 1: 1.6, 2: 3}, amplitude_factor={0: 1, 0.5: 0.7},
        loss_factor={"zeta": 0.05},
    ),
    "factors over frequency": tn.FlexibleCoupling(
        "e", nodes=("a", "b"), stiffness=700, loss_factor=0.1, frequency_factor={"1 Hz": 1, "100 Hz": 1.3}, damping=None
    ),
    "lumped shaft": tn.Shaft("e", nodes=("a", "b"), outer_diameter=0.1, inner_diameter=0.04, length=1, inertia="lumped"),
}  # fmt: skip
ELEMENTS = {kind: EVERY_ELEMENT[kind] for kind in sorted(ELEMENT_TYPES) if kind not in SHEETS} | MORE


def leaves(data, path=()):
    """Paths of all numbers in the entries of an element."""
    if isinstance(data, dict):
        return [leaf for key, value in data.items() for leaf in leaves(value, (*path, key))]
    if isinstance(data, list | tuple):
        return [leaf for place, value in enumerate(data) for leaf in leaves(value, (*path, place))]
    return [path] if isinstance(data, int | float) and not isinstance(data, bool) else []


def replaced(data, path, value):
    if not path:
        return value
    copy = dict(data) if isinstance(data, dict) else list(data)
    copy[path[0]] = replaced(data[path[0]], path[1:], value)
    return copy


def at(data, path):
    return at(data[path[0]], path[1:]) if path else data


def in_place(element, data, parameters):
    elements = {**around(element).elements, "e": make_element(element.kind, "e", data)}
    return tn.Drivetrain("around", elements.values(), parameters=parameters)


def parametrised(element):
    """A drivetrain around an element with a parameter for every number that may be one."""
    data, parameters = element.to_data(), {}
    del data["type"]
    for path in leaves(data):
        name = "_".join(["p", *map(str, path)]).replace(".", "_")
        changed, more = replaced(data, path, name), {**parameters, name: at(data, path)}
        try:
            model = in_place(element, changed, more)
        except (tn.ModelError, AttributeError, TypeError):
            continue
        if any(name in expression.names for _, _, expression, _ in model.elements["e"].expressions()):
            data, parameters = changed, more
    return in_place(element, data, parameters)


@pytest.mark.few(2, 20)
@pytest.mark.parametrize("which", ELEMENTS)
def test_every_element_as_in_single_models(which):
    model, rng = parametrised(ELEMENTS[which]), np.random.default_rng(len(which))
    known = list(model.parameters)
    assert bool(known) == (which not in PLAIN)
    alone = [name for name in known if batch_plan(model, [name]) is not None]
    for names in ([name] for name in alone):
        counts = require_like_single_models(batch_of(model, drawn(rng, model, names, 12)), rel=3e-14)
        assert counts["together"] >= 3
    if alone:
        counts = require_like_single_models(batch_of(model, drawn(rng, model, alone, 40)), rel=3e-14)
        assert counts["together"] >= 3
        assert counts["impossible"] >= 1


def test_the_elements_are_all_there():
    assert set(EVERY_ELEMENT) == set(ELEMENT_TYPES)


@pytest.mark.few(1, 6)
@pytest.mark.parametrize("name", library_cases())
def test_library_models_as_in_single_models(name):
    rng = np.random.default_rng(len(name))
    model = tn.load(name)
    for configuration in ("", *model.configurations[:2]):
        rig = model.configured(configuration)
        planned = [one for one in rig.parameters if batch_plan(rig, [one]) is not None]
        assert len(planned) >= len(rig.parameters) / 2
        counts = require_like_single_models(batch_of(rig, drawn(rng, rig, planned, 15)))
        assert counts["together"] >= 3


def chain(**changes):
    given = {"J_1": 0.2, "J_m": 0.05, "J_2": "J_1 - J_m", "k": 900, "c": 2} | changes
    return tn.Drivetrain(
        "chain",
        [
            tn.Inertia("rotor", node="a", inertia="J_m"),
            tn.Inertia("rest", node="a", inertia="J_2"),
            tn.Spring("shaft", nodes=("a", "b"), stiffness="k", damping="c"),
            tn.Spring("end", nodes=("b", "ground"), stiffness="2*k"),
            tn.Damper("drag", nodes=("a", "ground"), damping="c/4"),
        ],
        parameters=given,
        inputs={"T": {"torque": "a"}},
    )


class TestOneByOne:
    """What arrays cannot say is left to single models."""

    def test_digits_lost_in_a_difference(self):
        batch = batch_of(chain(), {"J_1": [0.2, 0.3], "J_m": [0.05, 0.2999999999]})
        assert batch.separate.tolist() == [False, True]
        assert batch.model(1).assembly.system.inertia[1] == 1e-10

    def test_exactly_nothing_left_of_decimals(self):
        model = chain(J_m="J_a + J_b", J_a=0.1, J_b=0.02)
        batch = batch_of(model, {"J_1": [0.2, 0.3], "J_a": [0.1, 0.1], "J_b": [0.1, 0.2]})
        assert batch.separate.tolist() == [True, True]
        assert len(batch.model(1).assembly.laws) == len(chain().assembly.laws) - 1

    def test_laws_that_vanish(self):
        batch = batch_of(chain(), {"k": [900.0, 0.0, 800.0], "c": [2.0, 1.0, 0.0]})
        assert batch.separate.tolist() == [False, True, True]
        assert not batch.impossible.any()
        assert batch.stacked.tolist() == [0]

    def test_damping_beside_a_stiffness_may_vanish(self):
        model = chain(c_1=2)
        model = tn.Drivetrain("c", [*model.elements.values()][:4], parameters=model.parameter_definitions)
        assert batch_of(model, {"c": [0.0, 2.0]}).stacked.tolist() == [0, 1]


class TestPlans:
    def test_ratios_have_rows_of_their_own(self):
        assert batch_plan(tn.load("amt_rig"), ["tau", "k_1"]) is None

    def test_unknown_and_no_names(self):
        with pytest.raises(tn.UsageError, match="unknown-parameter"):
            batch_plan(tn.load("dmf_rig"), ["k_3"])
        with pytest.raises(tn.UsageError, match="at least one"):
            batch_plan(tn.load("dmf_rig"), [])

    def test_values_are_those_of_the_plan(self):
        plan = batch_plan(tn.load("dmf_rig"), ["k_2", "c_2"])
        with pytest.raises(tn.UsageError, match="k_2, c_2"):
            plan.batch({"k_2": [1.0]})
        with pytest.raises(tn.UsageError, match="same number of values"):
            plan.batch({"k_2": [1.0, 2.0], "c_2": [1.0]})

    def test_parts_with_dots_in_their_names(self):
        car = tn.load("front_wheel_drive_car")
        batch = batch_of(car, {"left.k": [5000.0, 7000.0], "right.k_tyre": [8e3, 9e3]})
        assert require_like_single_models(batch)["together"] == 2

    def test_controllers_stay_as_they_are(self):
        around_one = around(EVERY_ELEMENT["controller"])
        elements = [one for one in around_one.elements.values() if one.name != "j_x"]
        model = tn.Drivetrain("c", [*elements, tn.Inertia("j_x", node="x", inertia="J")], parameters={"J": 0.7})
        assert require_like_single_models(batch_of(model, {"J": [0.5, 0.9]}))["together"] == 2

    def test_operating_point_of_another_speed(self):
        rig = following_rig()
        fast = rig.with_operating_values({"k_f": 777.0})
        batch = batch_of(fast, {"J": [0.1, 0.2]})
        assert batch.stiffness[0].tolist() == fast.assembly.system.stiffness.tolist()
        assert require_like_single_models(batch)["together"] == 2

    def test_what_follows_the_operating_point_may_be_varied_itself(self):
        batch = batch_of(following_rig(), {"k_f": [500.0, 600.0], "J": [0.1, 0.2]})
        assert require_like_single_models(batch)["together"] == 2

    def test_a_varied_operating_point_is_no_batch(self):
        assert batch_plan(following_rig(), ["n"]) is None


def following_rig():
    """A spring that follows the speed."""
    return tn.Drivetrain(
        "following",
        [
            tn.Inertia("rotor", node="a", inertia="J"),
            tn.Spring("field", nodes=("a", "ground"), stiffness="k_f", damping=1),
        ],
        parameters={
            "J": 0.3,
            "n": "100 rad/s",
            "k_f": {"by": "speed", "of": "a", "table": {"0 rpm": "100 N*m/rad", "3000 rpm": "400 N*m/rad"}},
        },
        operating_point={"speed": {"a": "n"}},
        speeds={"of": "a", "range": ["500 rpm", "2000 rpm"], "step": "100 rpm", "rated": "1000 rpm"},
    )


def test_no_model_is_made_for_a_variant(monkeypatch):
    rig, made = tn.load("amt_rig").configured("V"), []
    changed = Model._changed
    monkeypatch.setattr(Model, "_changed", lambda *args: made.append(1) or changed(*args))
    plan = batch_plan(rig, ["k_1", "c_O", "I_2"])
    assert len(made) == 1
    rng = np.random.default_rng(1)
    batch = plan.batch({name: rig.parameters[name] * rng.normal(1, 0.1, 1000) for name in plan.names})
    assert len(made) == 1
    assert len(batch.stacked) == 1000


def test_part_and_whole():
    model = parametrised(EVERY_ELEMENT["hysteretic_spring"])
    values = drawn(np.random.default_rng(5), model, list(model.parameters), 30)
    batch = batch_of(model, values)
    omega = np.array([3.0, 70.0])
    whole = batch.law_stiffness(omega)
    for which in (slice(3, 20, 2), [4, 1, 9], batch.stiffness[:, 0] > 0):
        part = batch.part(which)
        places = np.arange(30)[which]
        for (law, ours), (other, theirs) in zip(part.law_stiffness(omega).sampled, whole.sampled, strict=True):
            assert law == other
            np.testing.assert_array_equal(ours, theirs[places])
        np.testing.assert_array_equal(part.values["p_stiffness"], batch.values["p_stiffness"][places])
