"""Quantities of running machinery, of motion over time, of other quantities and of a user's own."""

import math
import pickle

import numpy as np
import pytest
from support.study_blocks import THREE, columns, dmf_rig, ship, ship_at_three_speeds, singly, spread

import torsionnet as tn
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.expression import function
from torsionnet.study.quantities.quantity import MOST_REMARKS, OTHERS, QUANTITIES, QuantityForm, VariantBlock


@pytest.fixture
def model(request: pytest.FixtureRequest) -> tn.Drivetrain:
    """Made when a test asks for it: to read models takes much of collecting."""
    return request.param()


def made(kind: str, **entries: object) -> object:
    return QUANTITIES[kind](**entries)


def fan(**changes: object) -> tn.Drivetrain:
    """Two rotors on a shaft of diameter d, excited by blades."""
    elements = [
        tn.Inertia("rotor", node="a", inertia=2),
        tn.Inertia("wheel", node="b", inertia="J"),
        tn.Shaft("shaft", nodes=("a", "b"), outer_diameter="d", length=1, shear_modulus=8e10, inertia="none"),
    ]
    given = {
        "speeds": {"of": "a", "list": ["600 rpm", "900 rpm"]},
        "excitations": {"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
        "limits": {"shaft": {"rule": "curve", "output": "stress(shaft)", "value": "40 MPa", "source": "maker"}},
        "parameters": {"J": 1.0, "d": 0.02},
    }
    return tn.Drivetrain("fan", elements, **{**given, **changes})


def half_ranges(model: tn.Drivetrain) -> np.ndarray:
    return model.order_response("T_cpl").half_range[:, 0]


def test_fewer_speeds_are_some_of_those_of_the_model() -> None:
    every = np.array(ship().definition.speeds.values)
    few = made("order_torque", output="T_cpl", speeds="400..500 rpm", every=10).at(ship())
    rpm = few * 30 / math.pi
    assert rpm == pytest.approx([400, 420, 440, 460, 480, 500])
    assert np.isin(few, every).all()
    assert made("utilisation", every=1000).at(ship()) == pytest.approx(every[[0, -1]])
    assert made("utilisation").at(ship()) == pytest.approx(every)


@pytest.mark.few(1)
@pytest.mark.parametrize("firing", ["normal", "misfire", "gas_off"])
def test_the_vibration_of_a_plant_is_that_of_every_variant(firing: str) -> None:
    model = ship_at_three_speeds().configured(f"firing={firing}")
    values = spread(model, ("k_cpl", "psi_cpl"), count=3)
    plant = Evaluator(model, tuple(values), {"T": made("order_torque", output="T_cpl"),
                                             "over speed": made("order_torque", output="T_cpl", curve=True)})  # fmt: skip
    assert plant.plan is not None
    found = plant(values)
    assert plant.quantities["over speed"].measure(model).points.tolist() == pytest.approx(list(THREE.values))
    for number, own in enumerate(columns(values)):
        alone = half_ranges(model.configured(**own))
        assert found["over speed"][number] == pytest.approx(alone, rel=1e-9)
        assert found["T"][number] == pytest.approx(alone.max(), rel=1e-9)


def test_one_order_of_an_engine_is_that_of_its_order_response() -> None:
    values = spread(ship_at_three_speeds(), ("k_cpl",), count=2)
    found = Evaluator(
        ship_at_three_speeds(),
        ("k_cpl",),
        {"T": made("order_torque", output="T_cpl", order=3.0, excitations=["engine"])},
    )(values)
    for value, own in zip(found["T"], columns(values), strict=True):
        run = ship_at_three_speeds().configured(**own).order_response("T_cpl", excitation=["engine"])
        assert value == pytest.approx(np.abs(run.of_order(3.0)).max(), rel=1e-9)


def test_one_order_in_the_worst_of_several_cases_is_the_largest_of_them() -> None:
    model = ship_at_three_speeds().configured("firing=misfire")
    found = Evaluator(model, ("k_cpl",), {"T": made("order_torque", output="T_cpl", order=0.5)})(
        {"k_cpl": np.array([3e5])}
    )
    cases = model.configured(k_cpl=3e5).order_response("T_cpl").alternatives.values()
    sizes = [np.abs(case.of_order(0.5)).max() for case in cases]
    assert max(sizes) > 1.0001 * sizes[0]
    assert found["T"][0] == pytest.approx(max(sizes), rel=1e-9)


def test_parameters_that_follow_the_speed_are_solved_at_every_speed() -> None:
    elements = [
        tn.Inertia("rotor", node="a", inertia=2),
        tn.Inertia("wheel", node="b", inertia="J"),
        tn.Spring("shaft", nodes=("a", "b"), stiffness="k"),
    ]
    rows = {"500 rpm": "10 kN*m/rad", "1000 rpm": "20 kN*m/rad"}
    model = tn.Drivetrain(
        "fan",
        elements,
        parameters={"J": 1.0, "k": {"by": "speed", "of": "a", "table": rows}},
        speeds={"of": "a", "list": ["600 rpm", "900 rpm"], "rated": "900 rpm"},
        excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
    )
    asked = {"T": made("order_torque", output="torque(shaft)", curve=True)}
    found = Evaluator(model, ("J",), asked)({"J": np.array([1.0, 1.2])})["T"]
    for row, J in zip(found, (1.0, 1.2), strict=True):
        for value, rpm, k in zip(row, (600, 900), (1.2e4, 1.8e4), strict=True):
            w = 2 * rpm * math.pi / 30
            assert value == pytest.approx(abs(10 / J / (1 / 2 + 1 / J - w**2 / k)), rel=1e-9)


def test_a_stress_knows_the_diameter_of_every_variant() -> None:
    model, d = fan(), np.array([0.018, 0.02, 0.024])
    found = Evaluator(model, ("d",), {"tau": made("order_torque", output="stress(shaft)"),
                                      "peak": made("peak", output="stress(shaft)", input="b", band="1..12 Hz")})({"d": d})  # fmt: skip
    for value, own in zip(found["peak"], d, strict=True):
        alone = made("peak", output="stress(shaft)", input="b", band="1..12 Hz")
        assert value == pytest.approx(
            alone.evaluate(singly(model.configured(d=own), {"J": np.array([1.0])}))[0, 0], rel=1e-9
        )
    for value, own in zip(found["tau"], d, strict=True):
        w, k = np.array([600, 900]) * math.pi / 15, 8e10 * math.pi * own**4 / 32
        torque = 10 * 1.0 / (1 / 2 + 1 - w**2 / k)
        assert value == pytest.approx(np.abs(torque).max() * 16 / (math.pi * own**3), rel=1e-9)


def of_tail_at_last(model: tn.Drivetrain) -> float:
    check = model.check_limits("tail", speeds=[THREE.values[-1]])
    return max(np.nanmax(one.utilisation) for one in check.verdicts)


@pytest.mark.slow
def test_utilisation_is_that_of_the_limits_of_every_variant() -> None:
    values = spread(ship_at_three_speeds(), ("k_cpl",), count=2)
    asked = {"all": made("utilisation"), "tail": made("utilisation", limit="tail"),
             "one": made("utilisation", limit="rubber", criterion="T_KW")}  # fmt: skip
    names = {one.criterion for one in ship_at_three_speeds().check_limits("rubber").verdicts}
    asked["last"] = made("utilisation", limit="tail", speeds="700..800 rpm")
    asked["one"] = made("utilisation", limit="rubber", criterion=min(names))
    found = Evaluator(ship_at_three_speeds(), ("k_cpl",), asked)(values)
    for number, own in enumerate(columns(values)):
        check = ship_at_three_speeds().configured(**own).check_limits()
        worst = [np.nanmax(one.utilisation) for one in check.verdicts]
        assert found["all"][number] == pytest.approx(max(worst), rel=1e-9)
        of_tail = [np.nanmax(one.utilisation) for one in check.verdicts if one.limit == "tail"]
        assert found["tail"][number] == pytest.approx(max(of_tail), rel=1e-9)
        assert found["last"][number] == pytest.approx(
            of_tail_at_last(ship_at_three_speeds().configured(**own)), rel=1e-9
        )
        single = check.of("rubber", min(names))
        assert found["one"][number] == pytest.approx(np.nanmax(single.utilisation), rel=1e-9)


def test_utilisation_has_no_value_where_one_of_the_limits_cannot_be_judged() -> None:
    curve = {"rule": "curve", "output": "stress(shaft)", "source": "maker"}
    near, far = ({**curve, "over_speed": {f"{rpm} rpm": "40 MPa", "2000 rpm": "40 MPa"}} for rpm in (500, 1200))
    block = VariantBlock(fan(limits={"near": near, "far": far}), {"d": np.array([0.02, 0.03])}, {}, None)
    assert np.isfinite(made("utilisation", limit="near").evaluate(block)).all()
    assert np.isnan(made("utilisation").evaluate(block)).all()


def moved(shape: str, w: float, rise: float) -> np.ndarray:
    """Angle over the static one of a mass on a spring, from tables of Laplace transforms."""
    t, p = np.linspace(0, 0.2, 400_001), math.pi / rise
    later = np.maximum(t - rise, 0)
    if shape == "step":
        return 1 - np.cos(w * t)
    if shape == "ramp":
        return (t - np.sin(w * t) / w - later + np.sin(w * later) / w) / rise
    waves = [(np.sin(p * one) - p / w * np.sin(w * one)) / (1 - (p / w) ** 2) for one in (t, later)]
    return waves[0] + waves[1]


@pytest.mark.parametrize("shape", ["step", "ramp", "half_sine"])
def test_a_transient_of_one_mass_is_that_of_the_closed_form(shape: str) -> None:
    elements = [tn.Inertia("m", node="a", inertia=2.0), tn.Spring("k", nodes=("a", "ground"), stiffness="k")]
    rig = tn.Drivetrain("one mass", elements, parameters={"k": 8e4})
    rise = {} if shape == "step" else {"rise": 0.02}
    quantity = made("transient_peak", output="a", input="a", torque=10, shape=shape, duration=0.2, rate=2e4, **rise)
    assert not list(quantity.model_faults(rig, {}))
    k = np.array([8e4, 1.6e5])
    found = quantity.evaluate(singly(rig, {"k": k}))[:, 0]
    for value, own in zip(found, k, strict=True):
        assert value == pytest.approx(10 / own * np.abs(moved(shape, math.sqrt(own / 2), 0.02)).max(), rel=1e-4)


def test_a_margin_is_taken_over_the_nearer_end_of_what_excites() -> None:
    elements = [
        tn.Inertia("rotor", node="a", inertia=2),
        tn.Inertia("wheel", node="b", inertia=1),
        tn.Spring("shaft", nodes=("a", "b"), stiffness="k"),
    ]
    blades = {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}, 7: {"amplitude": "1 N*m"}}}
    fan = tn.Drivetrain(
        "fan", elements, speeds={"of": "a", "list": [50, 60]}, parameters={"k": 1.5e4}, excitations={"blades": blades}
    )
    natural = np.array([60.0, 99.0, 110.0, 130.0, 200.0, 340.0])
    asked = {"two": made("critical_speed_margin", orders=[2.0]), "all": made("critical_speed_margin")}
    found = Evaluator(fan, ("k",), asked)({"k": natural**2 / 1.5})
    assert found["two"] == pytest.approx([0.4, 0.01, 0, 130 / 120 - 1, 200 / 120 - 1, 340 / 120 - 1], abs=1e-9)
    assert found["all"] == pytest.approx([0.4, 0.01, 0, 130 / 120 - 1, 1 - 200 / 350, 1 - 340 / 350], abs=1e-9)
    assert asked["two"].words.endswith("of orders 2")
    assert asked["all"].words.endswith("of all orders")


@pytest.mark.parametrize(
    ("band", "spacing", "middle"),
    [("1..100 Hz", None, 10), ("1..100 Hz", "linear", 50.5), ("1..9 Hz", None, 5), ("1..9 Hz", "log", 3),
     ("0..100 Hz", None, 50)],
)  # fmt: skip
def test_points_of_a_band_are_at_equal_factors_where_it_is_wide(band: str, spacing: str, middle: float) -> None:
    given = {"output": "T_T", "input": "T_M", "band": band, "points": 3, "spacing": spacing}
    asked, faults = QUANTITIES["response"].read({key: one for key, one in given.items() if one is not None})
    assert not faults
    assert asked.frequencies[1] == pytest.approx(middle)


def test_a_half_sine_is_over_after_its_rise() -> None:
    wave = {"torque": 10, "shape": "half_sine", "rise": 0.1, "duration": 0.2, "rate": 100}
    found = made("transient_peak", output="T_T", input="T_M", **wave).torques(dmf_rig()).values
    assert found == pytest.approx([*np.sin(np.pi * np.arange(11) / 10) * 10, *[0] * 10], abs=1e-12)


def test_a_torque_over_time_comes_from_a_recording_or_a_list(tmp_path) -> None:
    torque = [0.0, 5.0, 10.0, 5.0, 0.0, *[0.0] * 95]
    rows = "\n".join(f"{number / 1000},{value / 1000}" for number, value in enumerate(torque))
    (tmp_path / "shock.csv").write_text(f"time [s],T_M [kN*m]\n{rows}\n")
    with files_beside(tmp_path):
        recorded, faults = QUANTITIES["transient_peak"].read(
            {"output": "T_T", "input": "T_M", "history": {"file": "shock.csv", "channel": "T_M"}}
        )
        _, unknown = QUANTITIES["transient_peak"].read(
            {"output": "T_T", "input": "T_M", "history": {"file": "shock.csv", "channel": "T_N"}}
        )
        (tmp_path / "bare.csv").write_text("T_M\n" + "\n".join(str(value / 1000) for value in torque) + "\n")
        reading = {"rate": "1 kHz", "quantities": {"T_M": "torque"}, "units": {"T_M": "kN*m"}}
        told, wrong = QUANTITIES["transient_peak"].read(
            {"output": "T_T", "input": "T_M", "history": {"file": "bare.csv", "channel": "T_M", "reading": reading}}
        )
    listed = made("transient_peak", output="T_T", input="T_M", history={"rate": "1 kHz", "values": torque})
    assert not faults
    assert not wrong
    assert unknown[0].path == ("history", "channel")
    expected = np.abs(dmf_rig().configured(k_2=400).simulate("T_T", {"T_M": torque}, 1000)["T_T"].values).max()
    for one in (recorded, told, listed, QUANTITIES["transient_peak"].read(recorded.to_data())[0]):
        assert one.evaluate(singly(dmf_rig(), {"k_2": np.array([400.0])}))[0, 0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "entries",
    [
        {},
        {"torque": 1},
        {"torque": 1, "duration": 1, "history": {"rate": 1, "values": [0, 1]}},
        {"torque": 0, "duration": 1},
        {"torque": 1, "duration": 1, "rise": 1},
        {"torque": 1, "duration": 1, "shape": "ramp"},
        {"history": {"rate": 1, "values": [0, 1]}, "duration": 1},
        {"history": {"rate": 1, "values": [0]}},
        {"history": {"rate": 0, "values": [0, "x"]}},
        {"history": [0, 1]},
        {"history": {"file": "nowhere.csv", "channel": "T"}},
    ],
)
def test_transients_that_cannot_be_are_refused(entries: dict[str, object]) -> None:
    with pytest.raises(ModelError):
        made("transient_peak", output="T_T", input="T_M", **entries)


def test_margins_are_those_of_the_critical_speeds() -> None:
    held = ship_at_three_speeds().configured(
        Q_prop="188.7 kN*m", n_prop="151.8 rpm"
    )  # one set of modes instead of one a crossing
    values = spread(held, ("k_cpl",), count=3)
    asked = {"third": made("critical_speed_margin", orders=[3.0], excitations=["engine"], speeds="600..650 rpm")}
    found = Evaluator(held, ("k_cpl",), asked)(values)["third"]
    for value, own in zip(found, columns(values), strict=True):
        listed = held.configured(**own).critical_speeds(
            speeds=np.array([600, 650]) * math.pi / 30, excitation=["engine"], reach=0.9
        )
        assert value == pytest.approx(
            min(one.margin for one in listed.crossings if one.order == 3.0), rel=1e-9, abs=1e-15
        )
        assert value > 0


def test_an_expression_calculates_from_others_curves_too() -> None:
    H = made("response", output="theta_1", input="T_T", band="1..40 Hz", points=20)
    asked = {"H": H, "H0": made("response", output="theta_1", input="T_T", at=0),
             "amplification": made("expression", of="H/H0"), "root": made("expression", of="sqrt(amplification)^2*2")}  # fmt: skip
    evaluator = Evaluator(dmf_rig(), ("k_2",), asked)
    found = evaluator({"k_2": np.array([400.0, 500.0])})
    assert found["amplification"] == pytest.approx(found["H"] / found["H0"][:, None], rel=1e-15)
    assert found["root"] == pytest.approx(2 * found["amplification"], rel=1e-14)
    assert not [fault for one in asked.values() for fault in one.model_faults(dmf_rig(), asked)]
    measures = {name: one.measured(dmf_rig(), asked) for name, one in asked.items()}
    assert measures["amplification"].unit == ""
    assert measures["amplification"].is_curve
    assert made("expression", of="H0*H0").measured(dmf_rig(), asked).unit != ""
    assert made("expression", of="1/H0", unit="N*m/rad").measured(dmf_rig(), asked).unit == "N*m/rad"


def test_expressions_that_lead_nowhere_are_refused() -> None:
    asked = {"a": made("expression", of="b + 1"), "b": made("expression", of="2*c"), "c": made("expression", of="a/b"),
             "f": made("natural_frequency", mode=1), "z": made("damping_ratio", mode=1), "sum": made("expression", of="f + z"),
             "lost": made("expression", of="f_1 + g_2"),
             "one": made("response", output="theta_1", input="T_T", at=[1, 2]),
             "two": made("response", output="theta_1", input="T_T", at=[1, 3]), "both": made("expression", of="one - two")}  # fmt: skip
    said = {name: [fault.message for fault in one.model_faults(dmf_rig(), asked)] for name, one in asked.items()}
    assert "circle" in said["a"][0]
    assert "circle" in said["c"][0]
    assert "would add" in said["sum"][0]
    assert len(said["lost"]) == 2
    assert "different points" in said["both"][0]
    with pytest.raises(UsageError, match="circle"):
        VariantBlock(dmf_rig(), {"k_2": np.array([1.0])}, asked, None).of("a")
    with pytest.raises(ModelError):
        made("expression", of="__import__('os')")
    with pytest.raises(ModelError):
        made("expression", of="2*3")


def module_level(model: tn.Drivetrain) -> float:
    return model.parameters["k_2"] * 2


def test_a_function_of_a_user_is_asked_of_every_variant() -> None:
    curve = function(lambda model: [model.parameters["k_2"], 1.0], unit="N*m/rad", over="speed", points=[1.0, 2.0])
    asked = {"twice": function(module_level, unit="N*m/rad"), "curve": curve}
    found = Evaluator(dmf_rig(), ("k_2",), asked)({"k_2": np.array([400.0, 500.0])})
    assert found["twice"].tolist() == [800.0, 1000.0]
    assert found["curve"].tolist() == [[400.0, 1.0], [500.0, 1.0]]
    assert curve.measure(dmf_rig()).over == "speed"
    assert asked["twice"].measure(dmf_rig()).unit == "N*m/rad"


def multiple(factor: float):
    """Functions of one name and different code."""
    return (lambda model: 2 * model.parameters["k_2"]) if factor == 2 else (lambda model: 3 * model.parameters["k_2"])


def test_a_study_with_functions_runs_and_goes_on_only_with_the_same_code(tmp_path) -> None:
    def study(of):
        return tn.study.define(dmf_rig(), {"k_2": {"type": "list", "values": [400, 500]}}, {"twice": function(of)})

    assert tn.study.run_study(study(multiple(2)), tmp_path).values("twice").tolist() == [800, 1000]
    assert tn.study.run_study(study(multiple(2)), tmp_path).values("twice").tolist() == [800, 1000]
    with pytest.raises(UsageError, match="another"):
        tn.study.run_study(study(multiple(3)), tmp_path)
    with pytest.raises(UsageError):
        tn.study.run_study(study(lambda model: 2 * model.parameters["k_2"]), tmp_path)


def test_what_is_no_function_of_a_variant_is_refused() -> None:
    with pytest.raises(UsageError):
        function(3)
    with pytest.raises(UsageError):
        function(module_level, over="frequency")
    assert list(function(lambda _: [1.0, 2.0]).model_faults(dmf_rig(), {}))


FAULTS = [
    (dmf_rig, "order_torque", {"output": "T_T"}, "speeds"),
    (ship_at_three_speeds, "order_torque", {"output": "T_cpL"}, "did you mean"),
    (ship_at_three_speeds, "order_torque", {"output": "T_cpl", "order": 3.1}, "no order 3.1"),
    (ship_at_three_speeds, "order_torque", {"output": "T_cpl", "excitations": ["motor"]}, "no excitation"),
    (ship_at_three_speeds, "order_torque", {"output": "T_cpl", "speeds": "1..2 rpm"}, "none of the model's speeds"),
    (dmf_rig, "utilisation", {}, "no limits"),
    (ship_at_three_speeds, "utilisation", {"limit": "tale"}, "did you mean"),
    (ship_at_three_speeds, "utilisation", {"limit": "rubber", "criterion": "x"}, "rubber"),
    (dmf_rig, "critical_speed_margin", {}, "speeds"),
    (ship_at_three_speeds, "critical_speed_margin", {"orders": [3.1]}, "no order 3.1"),
    (dmf_rig, "scenario_peak", {"output": "T_T", "scenario": "tip_in"}, "no entry scenarios"),
    (dmf_rig, "transient_peak", {"output": "x", "input": "T_M", "torque": 1, "duration": 1}, "no sensor or node"),
    (dmf_rig, "transient_peak", {"output": "T_T", "input": "T_M", "torque": 1, "duration": 1, "rate": 1e8}, "samples"),
]


@pytest.mark.parametrize(("model", "kind", "entries", "words"), FAULTS, indirect=["model"])
def test_what_a_model_lacks_is_said(model: tn.Drivetrain, kind: str, entries: dict[str, object], words: str) -> None:
    said = " ".join(fault.message for fault in made(kind, **entries).model_faults(model, {}))
    assert words in said


@pytest.mark.parametrize("kind", sorted(QUANTITIES))
def test_every_quantity_goes_to_other_processes_and_into_a_file(kind: str) -> None:
    entries = {
        "band_mean": {"output": "T_cpl", "input": "T_prop", "band": "1..40 Hz"},
        "critical_speed_margin": {"orders": [3.0], "speeds": "700..788 rpm"},
        "damping_ratio": {"mode": 2, "order": "ascending"},
        "expression": {"of": "f/2", "unit": "Hz"},
        "natural_frequency": {"mode": 1, "which": "damped"},
        "order_torque": {"output": "T_cpl", "curve": True},
        "peak": {"output": "T_cpl", "input": "T_prop", "band": "1..40 Hz"},
        "peak_frequency": {"output": "T_cpl", "input": "T_prop", "band": "1..40 Hz"},
        "response": {"output": "T_cpl", "input": "T_prop", "at": 5},
        "scenario_peak": {"output": "T_LPB_G", "scenario": "two_phases", "rate": "1 kHz", "value": "highest"},
        "transient_peak": {"output": "T_cpl", "input": "T_prop", "torque": "1 kN*m", "duration": "1 s"},
        "utilisation": {"limit": "tail"},
    }[kind]
    quantity, faults = QUANTITIES[kind].read(entries)
    assert not faults
    asked = {"f": made("natural_frequency", mode=1), "own": quantity}
    model = tn.load("turbine_generator_ssr") if kind == "scenario_peak" else ship_at_three_speeds()
    assert not list(quantity.model_faults(model, asked))
    assert pickle.loads(pickle.dumps(quantity)) == quantity
    again, faults = QUANTITIES[kind].read(quantity.to_data())
    assert (again, faults) == (quantity, [])
    assert isinstance(quantity.measured(model, asked), QuantityForm)
    assert quantity.schema(type_key="type")["properties"]["type"]["const"] == kind


DAMPED = np.sqrt(400 / 0.001 - (0.1 / 0.002) ** 2) / (2 * np.pi)
"""Hz, of the lightest variant, with the last row of the table."""


@pytest.mark.parametrize(
    ("kind", "entries", "at_most"),
    [
        ("natural_frequency", {"mode": 1}, DAMPED),
        ("response", {"output": "a", "input": "a", "at": [5.0, 163.0]}, 163),
        ("peak", {"output": "a", "input": "a", "band": (2.0, 50.0)}, 50),
        ("order_torque", {"output": "torque(bush)"}, 30),
        ("order_torque", {"output": "torque(bush)", "curve": True}, 30),
        ("utilisation", {"limit": "bush"}, 30),
        ("critical_speed_margin", {}, DAMPED),
        ("transient_peak", {"output": "a", "input": "a", "torque": 1, "duration": 0.1, "rate": 1000}, 500),
        ("scenario_peak", {"scenario": "step", "output": "a"}, 600),
    ],
)
def test_a_study_notes_tables_that_are_read_beyond_their_rows(kind, entries, at_most, tmp_path):
    """Over all variants, in numbers by hand: order 2 at 900 rpm is 30 Hz, motion over time has half the rate."""
    rig = tn.Drivetrain(
        "bush",
        [
            tn.Inertia("J", node="a", inertia="J"),
            tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[0, 400, 0.1], [20, 400, 0.1]]),
        ],
        parameters={"J": 0.01},
        speeds={"of": "a", "range": "600..900 rpm", "step": "300 rpm"},
        excitations={"blades": {"type": "harmonic", "node": "a", "orders": {2: {"amplitude": "10 N*m"}}}},
        limits={"bush": {"rule": "curve", "output": "torque(bush)", "value": "40 N*m", "source": "maker"}},
        scenarios={"step": {"type": "torques", "duration": "0.1 s", "rate": "1.2 kHz", "torque": {"a": "1 N*m"}}},
    )
    vary = {"J": {"type": "list", "values": [0.01, 0.001, 0.004]}}
    study = tn.study.define(rig, vary, {"q": {"type": kind, **entries}})
    end = f"go from 0 to 20 Hz, and it is read at up to {at_most:.6g} Hz, where the last row is kept"
    expected = f"bush: the rows of its table {end}"
    assert expected in tn.study.run_study(study).notes
    assert expected in tn.study.run_study(study, tmp_path / "kept").notes
    assert expected in tn.study.run_study(study, tmp_path / "kept").notes  # read from its chunks


def test_a_block_keeps_few_remarks() -> None:
    block = singly(dmf_rig(), {"k_2": np.array([1.0])})
    for number in range(3 * MOST_REMARKS):
        block.remark(f"of {number}")
    assert len(block.remarks) == MOST_REMARKS + 1
    assert block.remarks[OTHERS] == 2 * MOST_REMARKS


def test_a_function_that_fails_says_of_which_variant():
    def picky(model):
        return 1 / (model.parameters["k_2"] - 500)

    study = tn.study.define(dmf_rig(), {"k_2": {"type": "list", "values": [400, 500]}}, {"picky": function(picky)})
    with pytest.raises(ZeroDivisionError) as error:
        tn.study.run_study(study)
    assert "picky was asked for the variant k_2 = 500" in error.value.__notes__[0]
