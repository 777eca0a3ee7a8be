"""Mean torques that leave something over are told."""

import pytest

import torsionnet as tn

PLANT = """\
torsionnet: 1
elements:
  motor: {{type: inertia, node: m, inertia: 1}}
  coupling: {{type: spring, nodes: [m, p], stiffness: 1e4}}
  gear: {{type: gear, nodes: [p, w], ratio: 4.0}}
  shaft: {{type: spring, nodes: [w, l], stiffness: 1e5}}
  load: {{type: inertia, node: l, inertia: 30}}
  water: {{type: damper, nodes: [l, ground], damping: 5}}
  brake: {{type: lock, node: {brake}}}
operating_point: {{speed: {{m: 1500 rpm}}, torque: {{{torque}}}}}
"""


def said(torque, brake=""):
    text = PLANT.format(torque=torque, brake=brake or "l")
    if not brake:
        text = text.replace("  brake: {type: lock, node: l}\n", "")
    return [fault.message for fault in tn.loads(text).check() if fault.severity == "warning"]


@pytest.mark.parametrize("torque", ["m: 100, l: -400", "m: 100, l: -391", "m: 100", "l: -400", "m: 0, l: 0"])
def test_torques_that_hold_each_other_or_say_half(torque):
    assert said(torque) == []


def test_a_load_with_the_sign_of_a_drive():
    (found,) = said("m: 100, l: 400")
    assert found.startswith("the mean torques (m 100 N*m, l 400 N*m) leave 800 N*m over at l")
    assert found.endswith('did you mean "l: -400 N*m"?')


def test_a_load_of_another_size():
    (found,) = said("m: 100, l: -100")
    assert "leave 300 N*m over at l" in found
    assert "did you mean" not in found


def test_what_is_held_needs_no_balance():
    assert said("m: 100, l: -100", brake="w") == []


def test_an_open_differential_balances_on_each_of_its_motions():
    def warnings(left, right):
        model = tn.Drivetrain(
            "axle",
            [
                tn.Inertia("cage", node="c", inertia=1),
                tn.Differential("diff", cage="c", left="a", right="b"),
                tn.Inertia("left", node="a", inertia=1),
                tn.Inertia("right", node="b", inertia=1),
            ],
            operating_point={"torque": {"c": 100, "a": left, "b": right}},
        )
        return [fault.message for fault in model.check() if fault.severity == "warning"]

    assert warnings(-50, -50) == []
    assert warnings(-60, -40)  # the side gears divide by half whatever they turn
