"""Sizes that are possible and hardly meant are asked about."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from support import models

import torsionnet as tn
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.model.checks.values import unusual_sizes

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
    found = tn.loads(text.replace("damping: {zeta: 0.02, at: 5 Hz}", "loss_factor: 50")).check()
    assert ("implausible-size", ("elements", "joint", "loss_factor")) in [(fault.kind, fault.path) for fault in found]


def test_an_inertia_that_nothing_has_is_asked_about():
    text = MODEL.format(**USUAL).replace("inertia: 1}", "inertia: 1e30}")
    assert any("inertia of 1e+30" in fault.message for fault in tn.loads(text).check())


LENGTHS = [
    (kind, name)
    for kind, element in models.EVERY_ELEMENT.items()
    for name, (spec, _) in element.scalars().items()
    if isinstance(spec, PhysicalQuantity) and spec.dimension == "length" and name != "length"
]


def asked(element):
    """Entries of an element about whose size a question is asked."""
    return [fault.path[2:] for fault in unusual_sizes(SimpleNamespace(elements={element.name: element}), {})]


@pytest.mark.parametrize(("kind", "name"), LENGTHS)
def test_no_length_of_an_element_is_sixty_metres(kind, name):
    """Typed in millimetres, as the radius of a crank or of the path of a pendulum; but for shafts, which may be long."""
    try:
        element = replace(models.EVERY_ELEMENT[kind], **{name: 60})
    except tn.ModelError:
        return  # contradicts the other entries
    assert (name,) in asked(element)
    assert (name,) not in asked(models.EVERY_ELEMENT[kind])


def test_slip_stiffness_in_kilonewtons():
    tyre = replace(models.EVERY_ELEMENT["tyre"], slip_stiffness=80)
    (fault,) = unusual_sizes(SimpleNamespace(elements={"e": tyre}), {})
    assert '"80 kN"?' in fault.message
