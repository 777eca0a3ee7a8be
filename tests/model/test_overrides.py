"""Configurations that change entries of elements."""

import numpy as np
import pytest

import torsionnet as tn

FILE = """torsionnet: 1
name: two gears
parameters: {{i_2: 2.5, k: 4 kN*m/rad}}
elements:
  motor: {{type: inertia, node: m, inertia: 0.2 kg*m^2}}
  stage: {{type: gear, nodes: [m, o], ratio: 4}}
  stiff: {{type: spring, nodes: [o, h], stiffness: k}}
  hub: {{type: inertia, node: h, inertia: 3 kg*m^2}}
inputs: {{T: {{torque: m}}}}
sensors: {{w: {{velocity: h}}}}
configurations:
  gear:
    I: {{}}
    II: {{{entry}}}
{more}"""


def rig(entry="stage.ratio: i_2", more=""):
    return tn.loads(FILE.format(entry=entry, more=more), file="rig.yaml")


def frequency(ratio):
    motor = 0.2 * ratio**2
    return np.sqrt(4e3 * (1 / motor + 1 / 3)) / (2 * np.pi)


def elastic(model):
    return max(model.modes().natural_frequencies)


def test_the_ratio_of_a_gear_is_that_of_the_configuration():
    assert elastic(rig()) == pytest.approx(frequency(4), rel=1e-12)
    assert elastic(rig().configured("I")) == pytest.approx(frequency(4), rel=1e-12)
    assert elastic(rig().configured("II")) == pytest.approx(frequency(2.5), rel=1e-12)
    assert elastic(rig().configured("II", i_2=3)) == pytest.approx(frequency(3), rel=1e-12)
    assert rig().configured("II").ratio_between("m", "h") == 2.5


def test_entries_may_make_rows_of_constraints_into_laws():
    """A mesh with a stiffness is no constraint any more; one degree of freedom comes in."""
    compliant = rig("stage.stiffness: 1 kN*m/rad").configured("II")
    series = 1 / (1 / (1e3 * 16) + 1 / 4e3)
    assert elastic(compliant) == pytest.approx(np.sqrt(series * (1 / (0.2 * 16) + 1 / 3)) / (2 * np.pi), rel=1e-12)


def test_round_trip_keeps_the_entries():
    again = tn.loads(rig().to_yaml())
    assert again == rig()
    assert elastic(again.configured("II")) == elastic(rig().configured("II"))


def test_in_python_the_same():
    made = tn.Drivetrain(
        "made",
        [
            tn.Inertia("a", node="a", inertia=1),
            tn.Spring("s", nodes=("a", "b"), stiffness=100),
            tn.Inertia("b", node="b", inertia=1),
        ],
        configurations={"soft": {"s.stiffness": "50 N*m/rad"}, "stiff": {}},
    )
    assert elastic(made.configured("soft")) == pytest.approx(10 / (2 * np.pi))


def test_an_excitation_of_the_same_name_goes_before_the_element():
    more = """speeds: {of: m, range: 300..750 rpm, step: 150 rpm}
excitations: {stage: {type: harmonic, node: m, orders: {1: {amplitude: 1 N*m}}}}
"""
    both = rig("stage.orders: {2: {amplitude: 3 N*m}}, stage.ratio: 2.5, i_2: 2", more).configured("II")
    assert both.ratio_between("m", "h") == 2.5
    assert both.definition.excitations["stage"].orders != rig(more=more).definition.excitations["stage"].orders


@pytest.mark.parametrize(
    ("entry", "where", "words"),
    [
        ("stoge.ratio: 2", "14:10", r":14:10: .*unknown-element"),
        ("stage.rotio: 2", "14:10", r":14:10: .*unknown-name"),
        ("stage.ratio: 2 kg", "14:23", r":14:23: .*wrong-unit"),
        ("stage.ratio: i_3", "14:23", r":14:23: .*unknown-parameter"),
        ("stage.ratio: k", "14:23", r":14:23: .*wrong-unit"),
        ("stage.ratio: 0", "14:23", r":14:23: .*out-of-range"),
        ("stage.teeth: [17, 61]", "14:10", r":14:10: .*contradicting-entries"),
        ("stage.nodes: [m, h]", "14:10", r":14:10: .*fixed-entry"),
        ("stage.enabled: false", "14:10", r":14:10: .*fixed-entry"),
        ("stage.damping: 2", "14:25", r":14:25: .*missing-entry"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_where_it_stands(entry, where, words):
    with pytest.raises(tn.ModelError, match=words) as caught:
        rig(entry)
    assert f"rig.yaml:{where}: error: " in str(caught.value)


def test_two_axes_do_not_change_the_same_entry():
    with pytest.raises(tn.ModelError, match=r":15:14: .*repeated-name"):
        rig(more="  more: {a: {stage.ratio: 3}}\n")
