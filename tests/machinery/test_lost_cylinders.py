"""Mean torque of conditions with a cylinder lost: what limits compare is the torque of that condition."""

from types import SimpleNamespace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.verdicts.limit_check import RuleText
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.model.channels import Input
from torsionnet.model.files.library import library_models
from torsionnet.model.load.lost_torques import remaining_by_node

RPM = np.pi / 30
RATIO = 0.2 / 0.84
"""Crank radius over rod length of the engine here."""
SAMPLES = 144
FIRED = 1e5 + 90e5 * np.exp(-(((np.arange(SAMPLES) + SAMPLES / 2) % SAMPLES - SAMPLES / 2 - 3) ** 2) / 60)
"""Pressure in Pa every 5 degrees of a four-stroke cycle, a bell that is highest 15 degrees after firing."""
LATE = 1e5 + 60e5 * np.exp(-(((np.arange(SAMPLES) + SAMPLES / 2) % SAMPLES - SAMPLES / 2 - 1) ** 2) / 60)
"""The same without injection: lower, and highest 5 degrees after top dead centre, so that a little work is left."""
CONDITIONS = {
    "normal": {},
    "off": {"engine.gas_off": [2]},
    "out": {"engine.misfire": [2]},
    "each": {"engine.misfire": "each"},
}


def plant(driven_by="engine", extra=(), **load):
    elements = [
        tn.Inertia("m1", node="c1", inertia=50), tn.Spring("crank", nodes=("c1", "c2"), stiffness=3e7),
        tn.Inertia("m2", node="c2", inertia=50), tn.Spring("k", nodes=("c2", "c3"), stiffness=3e7),
        tn.Inertia("m3", node="c3", inertia=400),
        tn.HystereticSpring("rubber", nodes=("c3", "pin"), stiffness=3e5, loss_factor=0.15),
        tn.Inertia("pinion", node="pin", inertia=15), tn.Gear("mesh", nodes=("pin", "wheel"), ratio=-4),
        tn.Inertia("screw", node="wheel", inertia=9000), tn.Damper("water", nodes=("wheel", "ground"), damping=4e4), *extra,
    ]  # fmt: skip
    engine = {
        "type": "reciprocating_engine", "speed_of": "c3", "cycle": 4, "cylinders": {1: "c1", 2: "c2", 3: "c3"},
        "firing_order": [1, 3, 2], "bore": 0.32, "stroke": 0.4, "rod_length": 0.84, "reciprocating_mass": 78,
        "gas": {"fired": FIRED.tolist(), "motored": LATE.tolist(), "rated": "750 rpm", "exponent": 2},
    }  # fmt: skip
    return tn.Drivetrain(
        "plant", elements, speeds={"of": "c3", "range": "400..780 rpm", "step": "20 rpm", "rated": "750 rpm"},
        load={"absorbed_at": "wheel", "power": 1.2e6, "torque_exponent": 2, "driven_by": {driven_by: 1}, **load},
        excitations={"engine": engine}, configurations={"firing": CONDITIONS},
        limits={"rubber": {"rule": "coupling", "element": "rubber", "T_KN": 2e4, "T_Kmax": 6e4},
                "teeth": {"rule": "gear", "element": "mesh", "vibratory_share": 0.3}},
    )  # fmt: skip


def work(pressure):
    """Mean of pressure times piston rate, by the slider crank as in textbooks: x' = sin + lambda sin cos/sqrt(...)."""
    phi = np.arange(SAMPLES) * np.radians(5)
    rate = np.sin(phi) + RATIO * np.sin(phi) * np.cos(phi) / np.sqrt(1 - (RATIO * np.sin(phi)) ** 2)
    return np.mean((pressure - 1e5) * rate)


LEFT = work(LATE) / work(FIRED)
KEPT = {"normal": 1, "off": 2 / 3, "out": (2 + LEFT) / 3, "each": (2 + LEFT) / 3}


@pytest.mark.parametrize("name", CONDITIONS)
@pytest.mark.parametrize("driver", ["engine", "c3"])
def test_the_coupling_carries_the_mean_torque_of_the_condition(name, driver):
    """Power over speed, of it what the cylinders that work give, also where a node is named as the driver."""
    assert 0.02 < LEFT < 0.5
    rig = plant(driver).configured(name)
    run = rig.mean_response(["torque(rubber)", "torque(mesh, wheel)"], [500 * RPM, 750 * RPM])
    full = 1.2e6 / (750 * RPM) * np.array([(500 / 750) ** 2, 1])
    assert run.values == pytest.approx(KEPT[name] * np.outer(full, [1, -4]), rel=1e-9)
    assert bool(run.notes) is (name != "normal")


def test_the_lost_cylinder_gives_nothing_and_the_others_what_they_gave():
    run = plant().configured("off").mean_response(["torque(crank)", "torque(k)", "torque(rubber)"], [750 * RPM])
    assert run.values[0] == pytest.approx(1.2e6 / (750 * RPM) * np.array([1, 1, 2]) / 3, rel=1e-9)


@pytest.mark.parametrize("ratio", [1.0, -1.0])
def test_an_engine_that_turns_against_the_reference_loses_the_same(ratio):
    """Work of a fired cylinder as its load, in proportion to speed; what is left without injection is always that."""
    half = (FIRED + 1e5) / 2
    engine = EngineEntries(
        speed_of="c1", cycle=4, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2], bore=0.32, stroke=0.4,
        rod_length=0.84, misfire=[2], load={"mean_indicated_pressure": "20 bar", "rated": "750 rpm", "exponent": 1},
        gas={"traces": {"20 bar": FIRED.tolist(), "10 bar": half.tolist()}, "motored": LATE.tolist()},
    )  # fmt: skip
    places = [Input("torque", node) for node in ("c1", "c2")]
    definition = SimpleNamespace(excitations={"engine": engine})
    found = remaining_by_node(definition, {"c1": ratio}, np.array([400, 750]) * RPM, places, [])
    assert found["c2"] == pytest.approx([LEFT * 750 / 400, LEFT])


def test_the_powers_are_in_balance():
    balance = plant().configured("out").power_balance(600 * RPM)
    assert sum(balance.powers.values()) == pytest.approx(0, abs=1e-3)
    assert -balance.powers["wheel"] == pytest.approx(KEPT["out"] * 1.2e6 * (600 / 750) ** 3)


@pytest.mark.parametrize("name", ["off", "each"])
def test_limits_compare_the_mean_torque_of_the_condition(name):
    """T_Kmax adds it to the half range; teeth part above it. A share of the rated torque stays one of full load."""
    check = plant().configured(name).check_limits(refine=False)
    rated = 1.2e6 / (750 * RPM)
    mean = KEPT[name] * rated * (check.rpm / 750) ** 2
    half = plant().configured(name).order_response(["torque(rubber)"], speeds=check.speeds).half_range[:, 0]
    assert check.of("rubber", "T_KN").values == pytest.approx(mean, rel=1e-9)
    assert check.of("rubber", "T_Kmax").values == pytest.approx(mean + half, rel=1e-9)
    assert check.of("teeth", "hammer").allowed == pytest.approx(mean, rel=1e-9)
    assert check.of("teeth", "T_v").allowed == pytest.approx(0.3 * rated, rel=1e-9)
    assert any("% of the mean torque with all working" in note for note in check.notes)


PROPELLER = tn.Propeller("law", node="wheel", inertia=90, exponent=2, torque=1.2e6 / (187.5 * RPM), speed="187.5 rpm")
"""Law of motion over the absolute speed of the screw, with all of its torque at the rated speed."""


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_propeller_with_a_law_of_motion_takes_what_the_cylinders_left_give(name):
    """T = k P/Omega in the coupling and 4 T in the wheel, as without the law: P is that of all cylinders, k is left."""
    rig = plant(extra=(PROPELLER,)).configured(name)
    torque = KEPT[name] * 1.2e6 / (750 * RPM)
    run = rig.mean_response(["torque(rubber)", "torque(mesh, wheel)"], [500 * RPM, 750 * RPM])
    assert run.values == pytest.approx(torque * np.outer([(500 / 750) ** 2, 1], [1, -4]), rel=1e-9)
    state = rig.static_state()
    assert state.of("rubber").torque == pytest.approx(torque, rel=1e-9)
    assert state.external["wheel"] == pytest.approx(4 * torque, rel=1e-9)
    assert any("% of the mean torque with all working" in note for note in state.notes) == (name != "normal")


@pytest.mark.parametrize("name", ["off", "each"])
def test_limits_compare_the_mean_torque_of_the_condition_with_laws_of_motion(name):
    """Teeth part above the mean torque that is left, and T_Kmax adds that; shares are those of full load."""
    check = plant(extra=(PROPELLER,)).configured(name).check_limits(refine=False)
    rated = 1.2e6 / (750 * RPM)
    mean = KEPT[name] * rated * (check.rpm / 750) ** 2
    assert check.of("rubber", "T_KN").values == pytest.approx(mean, rel=1e-9)
    assert check.of("teeth", "hammer").allowed == pytest.approx(mean, rel=1e-9)
    assert check.of("teeth", "T_v").allowed == pytest.approx(0.3 * rated, rel=1e-9)


@pytest.mark.parametrize(("throws", "left"), [("[]", 1), ("[1, 2]", 0.5), ("[1, 2, 3, 4]", 0)])
def test_an_induction_motor_gives_what_the_throws_that_work_take(tmp_path, throws, left):
    """Each throw takes 1507 N m, or nothing without gas torque; the motor turns 2.96 times as fast, the other way."""
    text = library_models()["reciprocating_compressor_train"].read_text(encoding="utf-8")
    machine = "synchronous_speed: 1500 rpm, breakdown_torque: 5.2 kN*m, rated_torque: 2.04 kN*m, rated_slip: 1.33 %"
    text = text.replace("rotor: {type: inertia", f"rotor: {{type: induction_machine, {machine}")
    text = text.replace("full: {}", f"full: {{compressor.gas_off: {throws}}}")
    (tmp_path / "train.yaml").write_text(text)
    train = tn.load(tmp_path / "train.yaml").configured("full")
    run = train.mean_response(["torque(coupling)", "torque(front)"], [1480 * RPM])
    assert run.values[0] == pytest.approx(np.array([4 * 1507 / 2.96, -4 * 1507]) * left, rel=1e-9, abs=1e-9)


def two_motors(**limit):
    """Two motors on one wheel, 100 kW each at 1500 rpm; alone, the first gives 100 kW and the second idles; a tenth."""
    elements = [
        tn.Inertia("Ja", node="a", inertia=2), tn.Spring("ka", nodes=("a", "pa"), stiffness=1e5),
        tn.Gear("ga", nodes=("pa", "w"), ratio=-2), tn.Inertia("Jb", node="b", inertia=2),
        tn.Spring("kb", nodes=("b", "pb"), stiffness=1e5), tn.Gear("gb", nodes=("pb", "w"), ratio=-2),
        tn.Inertia("wheel", node="w", inertia=20), tn.Spring("kp", nodes=("w", "p"), stiffness=1e6),
        tn.Inertia("pump", node="p", inertia=10),
    ]  # fmt: skip
    return tn.Drivetrain(
        "two", elements, speeds={"of": "a", "range": "900..1500 rpm", "step": "100 rpm", "rated": "1500 rpm"},
        load={"absorbed_at": "p", "power": "200 kW", "torque_exponent": 2, "driven_by": {"a": 0.5, "b": 0.5}},
        excitations={"vanes": {"type": "harmonic", "node": "p", "orders": {3: {"amplitude": "10 N*m"}}}},
        configurations={
            "both": {}, "alone": {"load.driven_by": {"a": 1}, "load.power": "100 kW"}, "pitch": {"load.power": "20 kW"},
            "slow": {"load.driven_by": {"a": 1}, "speeds.range": "900..1060 rpm"},
        },
        limits={"teeth": {"rule": "gear", "element": "gb", "source": "maker", **limit}},
    )  # fmt: skip


def test_a_share_of_the_rated_torque_of_an_idle_mesh_is_that_of_full_load():
    """100 kW at 1500 rpm are 636.6 N m in the second mesh; alone it has none, and hammers in any vibration.

    Without pitch it has a tenth, against which hammer is judged, and not the share. One motor alone may not reach rated
    speed.
    """
    rated, rig = 100e3 / (1500 * RPM), two_motors(vibratory_share="30 %")
    both, alone, pitch, slow = checks = [rig.configured(name).check_limits() for name in rig.configurations]
    assert both.of("teeth", "hammer").allowed == pytest.approx(rated * (both.rpm / 1500) ** 2, rel=1e-9)
    assert pitch.of("teeth", "hammer").allowed == pytest.approx(0.1 * rated * (pitch.rpm / 1500) ** 2, rel=1e-9)
    for check in checks:
        assert check.of("teeth", "T_v").allowed == pytest.approx(0.3 * rated, rel=1e-9)
        assert check.of("teeth", "T_v").verdict == "pass"
    for check in (alone, slow):
        hammer = check.of("teeth", "hammer")
        assert (hammer.verdict, hammer.absent) == ("not judged", True)
    assert LimitConclusion(tuple(checks)).verdict == "pass"
    slower = rig.with_definition(rig.configured("alone").definition).check_limits(speeds=[900 * RPM, 1060 * RPM])
    assert "the rated speed is not among the speeds" in str(slower.of("teeth", "T_v").remarks)


def test_where_nothing_is_allowed_the_largest_value_is_the_worst():
    """A train whose compressor has no gas torque at all: teeth that shake without a mean torque."""
    speeds, values = np.array([50.0, 60, 70]), np.array([3.0, 8, 5])
    verdict = LimitVerdict(
        limit="teeth", of="gb", criterion="hammer", quantity="half range", unit="N*m", speeds=speeds, values=values,
        allowed=np.zeros(3), verdict="fail", text=RuleText("maker", "", ""),
    )  # fmt: skip
    assert (verdict.worst_value, verdict.worst_allowed, verdict.worst_utilisation) == (8, 0, None)
    assert verdict.worst_rpm == pytest.approx(60 / RPM)


def test_a_compressor_with_a_head_end_lost_takes_less():
    """Three throws take 1507 N m, one the share of its indicated torque; the motor turns 2.96 times as fast."""
    train = tn.load("reciprocating_compressor_train")
    gas = train.definition.excitations["compressor"].gas
    phi = 2 * np.pi * np.arange(90) / 90
    ratio = 0.075 / 0.4
    rate = np.sin(phi) + ratio * np.sin(phi) * np.cos(phi) / np.sqrt(1 - (ratio * np.sin(phi)) ** 2)
    left = np.mean(gas.motored.values * rate) / np.mean(gas.fired.values * rate)
    lost = train.configured("one_head_end_lost")
    assert lost.mean_response("torque(coupling)", [1480 * RPM]).values[0, 0] == pytest.approx(
        1507 * (3 + left) / 2.96, rel=1e-9
    )
    half = train.configured("half").mean_response("torque(coupling)", [1480 * RPM]).values[0, 0]
    assert half == pytest.approx(1507 * 4 * left / 2.96, rel=1e-9)
