"""Sizes that are possible and hardly meant are asked about."""

import pytest

import torsionnet as tn

MODEL = """\
torsionnet: 1
parameters: {{D: 110, half: 0.02, both: D*half}}
elements:
  disc: {{type: inertia, node: a, inertia: 1}}
  shaft: {{type: shaft, nodes: [a, b], outer_diameter: {diameter}, length: {length}, shear_modulus: {modulus}}}
  joint: {{type: spring, nodes: [b, c], stiffness: 1e4, damping: {{{damping}}}}}
  load: {{type: inertia, node: c, inertia: both}}
"""
USUAL = {"diameter": "70 mm", "length": "1.5", "modulus": "80 GPa", "damping": "zeta: 0.02, at: 5 Hz"}


def warnings(**changes):
    return [fault.message for fault in tn.loads(MODEL.format(**USUAL | changes)).check() if fault.severity == "warning"]


def test_usual_sizes_are_left_alone():
    assert warnings() == []
    assert warnings(length="5 km", diameter="4 m", damping="zeta: half, at: 5 Hz") == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"diameter": "70"}, 'outer diameter of 70 m: usual are 0.001 to 5 m; .* did you mean "70 mm"[?]'),
        ({"diameter": "70 m"}, "outer diameter of 70 m: usual are 0.001 to 5 m$"),
        ({"diameter": "D"}, "outer diameter of 110 m: usual are 0.001 to 5 m$"),
        ({"diameter": "10 um"}, "outer diameter of 1e-05 m"),
        ({"modulus": "80"}, 'did you mean "80 GPa"[?]'),
        ({"modulus": "0.00000001"}, "shear modulus of 1e-08 Pa: usual are 100000 to 1e[+]12 Pa$"),
        ({"damping": "zeta: 2, at: 5 Hz"}, "zeta = 2 is 200 %; did you mean 0.02[?]"),
        ({"damping": "eta: D, at: 5 Hz"}, "eta = 110 is 11000 %; did you mean 1.1[?]"),
    ],
)
def test_others_are_asked_about(change, message):
    import re

    (found,) = warnings(**change)
    assert re.search(message, found), found


def test_place_is_the_entry():
    (fault,) = [
        fault for fault in tn.loads(MODEL.format(**USUAL | {"diameter": "70"})).check() if fault.severity == "warning"
    ]
    assert (fault.position.line, fault.position.column) == (5, 55)


def test_a_value_on_its_bound_is_inside():
    text = MODEL.format(**USUAL).replace("half: 0.02", "half: {value: 0.02 kg*m^2, bounds: [0.02, 0.15]}")
    text = text.replace("both: D*half", "both: D*0.01")
    text = text.replace("inertia: 1}", "inertia: half}", 1)
    assert [fault.message for fault in tn.loads(text).check() if "bounds" in fault.message] == []


def test_a_loss_factor_in_percent_is_asked_about():
    text = MODEL.format(**USUAL).replace("type: spring", "type: hysteretic_spring")
    assert "eta = 50 is 5000 %; did you mean 0.5?" in [
        fault.message for fault in tn.loads(text.replace("damping: {zeta: 0.02, at: 5 Hz}", "loss_factor: 50")).check()
    ]


def test_an_inertia_that_nothing_has_is_asked_about():
    text = MODEL.format(**USUAL).replace("inertia: 1}", "inertia: 1e30}")
    assert any("mass moment of inertia of 1e+30" in fault.message for fault in tn.loads(text).check())
