"""Sizes of engines, propellers and limits that are possible and hardly meant, and what is proposed instead."""

import re

import numpy as np
import pytest

import torsionnet as tn

ANGLES = np.arange(720)


def compression(ratio=12.0):
    """Pa: 4 bar and a polytropic compression to 4 bar times ratio^1.35 at 0 degrees of 720."""
    volume = 1 + (ratio - 1) * (1 - np.cos(np.radians(ANGLES))) / 2
    pressure = 4e5 * (ratio / volume) ** 1.35
    return np.where((ANGLES >= 180) & (ANGLES < 540), 4e5, pressure)


FIRED = compression() + 8e6 * np.exp(-(((ANGLES - 20) / 25) ** 2)) * (ANGLES < 180)
FIRED[0] = compression()[0]
ENGINE = {
    "type": "reciprocating_engine", "speed_of": "c", "cycle": 4, "cylinders": {1: "c"}, "firing_order": [1],
    "bore": "320 mm", "stroke": "400 mm", "rod_length": "840 mm", "reciprocating_mass": "78 kg",
    "gas": {"fired": FIRED.tolist(), "motored": compression().tolist()},
}  # fmt: skip
SCREW = {"type": "propeller", "node": "c", "blades": 4, "torque": "1 kN*m", "rated": "100 rpm"}
RUBBER = {"rule": "coupling", "element": "k", "T_KN": "50 kN*m", "T_Kmax": "75 kN*m", "T_KW": "15 kN*m", "P_KV": "1 kW"}


def plant(engine=None, screw=None, limits=None, speeds=None):
    return tn.Drivetrain(
        "plant",
        [
            tn.Inertia("c", node="c", inertia=100),
            tn.Spring("k", nodes=("c", "d"), stiffness=1e6, damping=1e2),
            tn.Inertia("d", node="d", inertia=100),
        ],
        speeds=speeds or {"of": "c", "list": ["700 rpm", "750 rpm"]},
        excitations={"engine": engine or ENGINE} | ({"screw": screw} if screw else {}),
        limits={"rubber": limits} if limits else {},
    )


def engine(**changes):
    gas = ENGINE["gas"] | changes.pop("gas", {})
    return ENGINE | changes | {"gas": gas}


def warned(rig):
    return {".".join(map(str, one.path)): one.message for one in rig.check() if one.severity == "warning"}


def test_usual_machines_are_left_alone():
    usual = plant(screw=SCREW | {"blade_orders": {1: {"share": "6 %"}, 4: {"share": "1 %"}}}, limits=RUBBER)
    assert warned(usual) == {}


@pytest.mark.parametrize(
    ("changes", "place", "words"),
    [
        ({"reciprocating_mass": "78000 kg"}, "reciprocating_mass",
         '78000 kg .*320 mm .*400 mm: .*0.97 to 9700 kg; .*"78000 g"[?]'),
        ({"reciprocating_mass": "0.078 kg"}, "reciprocating_mass", '"0.078 t"[?]'),
        ({"gas": {"crankcase": "100 bar"}}, "gas.crankcase",
         '100 bar: .*0.2 to 10 bar; .*"100 kPa"[?]'),
        ({"gas": {"crankcase": 1}}, "gas.crankcase", "Pa, .*1 bar"),
        ({"gas": {"motored": (10 * compression()).tolist()}}, "gas.motored",
         "1145 bar, .*171 bar"),
        ({"gas": {"motored": (compression() / 10).tolist()}}, "gas.motored", "MPa for bar[?]"),
        ({"gas": {"fired": (10 * FIRED).tolist(), "motored": (10 * compression()).tolist()}}, "gas.fired",
         "400 bar; .*bar for MPa[?]"),
    ],
)  # fmt: skip
def test_sizes_of_an_engine_that_are_not_met(changes, place, words):
    found = warned(plant(engine(**changes)))
    assert list(found) == [f"excitations.engine.{place}"]
    assert re.search(words, found[f"excitations.engine.{place}"])


def test_a_motored_file_in_bar_under_a_heading_of_megapascal(tmp_path):
    rows = "\n".join(f"{angle};{pressure / 1e5:.4f}" for angle, pressure in zip(ANGLES, compression(), strict=True))
    (tmp_path / "motored.csv").write_text(f"angle [deg];pressure [MPa]\n{rows}\n", encoding="utf-8")
    rig = plant(engine(gas={"motored": tmp_path / "motored.csv"}))
    (found,) = (one for one in rig.check() if one.severity == "warning")
    assert re.search(r"1145 bar.*bar for MPa[?]$", found.message)
    assert (found.position.file, found.position.line, found.kind) == ("motored.csv", 1, "implausible-size")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"bore": "3200 mm"}, 'bore of 3.2 m .*"320 mm".*implausible-size'),
        ({"bore": 320}, "bore of 320 m .* m, .*320 mm.*implausible-size"),
        ({"stroke": 12}, 'stroke of 12 m .*"1200 mm".*implausible-size'),
        ({"gas": {"fired": (FIRED / 1e5).tolist()}}, r" Pa, .*1\d\d\.\d+ bar"),
        ({"gas": {"fired": FIRED[:361].tolist()}}, "720 deg .*360 deg .*unfit-curve"),
    ],
)  # fmt: skip
def test_remedies_are_of_a_size_that_is_met(changes, words):
    with pytest.raises(tn.ModelError) as error:
        plant(engine(**changes))
    assert re.search(words, str(error.value)), str(error.value)


def test_half_a_cycle_in_a_file(tmp_path):
    """0 to 360 degrees of a four-stroke engine: from firing to gas exchange."""
    rows = "\n".join(f"{angle};{FIRED[angle] / 1e5:.4f}" for angle in range(361))
    rows = rows.replace(f"360;{FIRED[360] / 1e5:.4f}", "360;3.5")
    (tmp_path / "half.csv").write_text(f"angle [deg];pressure [bar]\n{rows}\n", encoding="utf-8")
    with pytest.raises(tn.ModelError, match=r":362:1: .*114\.539.*3\.5.*unfit-curve"):
        plant(engine(gas={"fired": tmp_path / "half.csv"}))


@pytest.mark.parametrize(("orders", "words"), [
    ((4, 8), " 4 of 4 blades .*16 .* 1?"),
    ((8,), " 8 of 4 blades .*32 .* 2?"),
])  # fmt: skip
def test_blade_orders_counted_by_revolutions(orders, words):
    table = {order: {"share": "6 %"} for order in orders}
    assert re.search(words.replace("?", "[?]"), warned(plant(screw=SCREW | {"blade_orders": table}))[
        "excitations.screw.blade_orders"])  # fmt: skip
    conditions = {"astern": {"torque": 1, "blade_orders": table}}
    found = warned(plant(screw=SCREW | {"blade_orders": {1: {"share": "6 %"}}, "conditions": conditions}))
    assert list(found) == ["excitations.screw.conditions.astern.blade_orders"]


def test_a_bare_torque_beside_kilonewtonmetres():
    found = warned(plant(limits=RUBBER | {"T_KW": 15}))
    assert found == {
        "limits.rubber.T_KW": "T_KW of 15 N*m beside T_Kmax of 75000 N*m; a number without unit is in N*m: "
        'did you mean "15 kN*m"?'
    }


def test_a_range_of_speeds_without_unit():
    """It was read in rad/s, and what depends on the speed was blamed."""
    with pytest.raises(tn.ModelError, match=r"speeds\.range: .*300.*300.*missing-unit"):
        plant(speeds={"of": "c", "range": "300..788", "step": "2 rpm"})
    text = """torsionnet: 1
elements:
  c: {type: inertia, node: c, inertia: 100}
  k: {type: spring, nodes: [c, d], stiffness: 1e6, damping: 100}
  d: {type: inertia, node: d, inertia: 100}
speeds: {of: c, range: 300..788, step: 2 rpm, rated: 750 rpm}
load: {absorbed_at: d, power: 3 MW, torque_exponent: 2, driven_by: {c: 1}}
limits: {k: {rule: gear, element: k, vibratory_share: 30 %}}
"""
    with pytest.raises(tn.ModelError) as error:
        tn.loads(text)
    assert [fault.path for fault in error.value.faults] == [("speeds", "range")]
    assert tn.loads(text.replace("300..788", "[31.4, 82.5]")).definition.speeds.range == (31.4, 82.5)


def test_an_engine_that_is_declutched_and_still_acts_is_told():
    """It turns by itself then: no speed of its orders follows from that of the reference shaft."""
    rig = tn.Drivetrain(
        "plant", plant().elements.values(), speeds={"of": "d", "list": ["700 rpm"], "rated": "750 rpm"},
        excitations={"engine": ENGINE},
        configurations={"clutch": {"in": {}, "out": {"off": ["k"]}, "stopped": {"off": ["k"], "engine.enabled": False}}},
    )  # fmt: skip
    told = [(fault.configuration, fault.message) for fault in rig.check() if fault.kind == "no-ratio"]
    ((configuration, message),) = told
    assert configuration == "out"
    assert message.endswith("switch it off there, engine.enabled: false")
