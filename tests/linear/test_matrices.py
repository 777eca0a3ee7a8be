"""Matrices M, C and K in numbers."""

import re

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn


def test_reflected_terms_of_a_gear():
    """J/tau^2, c/tau^2 and k/tau^2 behind a gear of ratio 4 at the node before it."""
    rig = tn.Drivetrain(
        "geared",
        [
            tn.Inertia("J_1", node="a", inertia=0.5),
            tn.Gear("gear", nodes=("a", "b"), ratio=4),
            tn.Inertia("J_2", node="b", inertia=8),
            tn.Spring("shaft", nodes=("b", "ground"), stiffness=3200, damping=16),
        ],
    )
    found = rig.matrices()
    assert (found.coordinates, found.nodes) == (("a",), ("a", "b"))
    np.testing.assert_allclose([found.M.item(), found.C.item(), found.K.item()], [0.5 + 8 / 16, 1, 200])
    np.testing.assert_allclose(found.T, [[1], [0.25]])


@pytest.mark.parametrize("name", ["dmf_rig", "amt_rig", "planetary_set"])
def test_they_give_the_responses_of_the_drivetrain(name):
    rig = tn.load(name)
    rig = rig.configured(rig.configurations[0]) if rig.configurations else rig
    system = rig.matrices()
    name, driven = next(iter(rig.inputs.items()))
    s = 2j * np.pi * 9
    load = system.T[system.nodes.index(next(iter(driven.row)))]
    q = np.linalg.solve(system.M * s * s + system.C * s + system.K, load)
    H = rig.frequency_response([f"angle({node})" for node in system.nodes], name, [9])
    np.testing.assert_allclose(system.T @ q, H.values[0, :, 0], rtol=1e-9, atol=1e-12 * np.abs(H.values).max())


def test_stiffness_over_frequency_needs_one():
    rig = geared_line()
    rubber = tn.HystereticSpring("rubber", nodes=("m", "g"), stiffness=900, loss_factor=0.1)
    soft = tn.Drivetrain("h", [*rig.elements.values(), rubber], rig.parameters, rig.inputs, rig.sensors)
    with pytest.raises(tn.UsageError, match=r"(?s)12.*missing-entry"):
        soft.matrices()
    with_rubber, without = soft.matrices(at="12 Hz"), rig.matrices(at=12)
    assert (with_rubber.frequency, without.frequency) == (12, 12)
    a, b = (with_rubber.T[with_rubber.nodes.index(node)] for node in ("m", "g"))
    np.testing.assert_allclose(with_rubber.K - without.K, (900 + 90j) * np.outer(a - b, a - b))
    for at in (-1, "12 kg", "k"):
        with pytest.raises(tn.UsageError, match="at: "):
            rig.matrices(at=at)


def test_a_table_over_frequency_is_read_at_that_frequency():
    table = tn.TabulatedSpring("rubber", nodes=("a", "ground"), table=[[1, 300, 2], [9, 500, 1]])
    rig = tn.Drivetrain("rig", [tn.Inertia("J", node="a", inertia=1), table])
    stiffness = [rig.matrices(at=at).K.item().real for at in (0, 1, "9 Hz")]
    np.testing.assert_allclose(stiffness, [300, 300, 500], rtol=1e-12)


def controlled(**entries):
    """A mass with a controller on its velocity."""
    return tn.Drivetrain(
        "controlled",
        [
            tn.Inertia("J", node="a", inertia=2),
            tn.Inertia("J_b", node="b", inertia=1),
            tn.Spring("k", nodes=("a", "b"), stiffness=50),
            tn.Controller("governor", sense={"velocity": "a"}, act="b", **entries),
        ],
    )


def test_controllers_without_states_have_a_place_in_them():
    """A torque of -7 N m s/rad times the speed of a acts on b: C[b, a] = 7."""
    system = controlled(law=-7).matrices()
    row, column = (system.coordinates.index(node) for node in ("b", "a"))
    expected = np.zeros((2, 2))
    expected[row, column] = 7
    np.testing.assert_array_equal(system.C, expected)


def test_what_has_no_matrices_says_so():
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        controlled(law=-7, delay=0.01).matrices()
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        controlled(law={"p": -7, "i": -3, "d": 2, "filter": 0.1}).matrices()
    turned = tn.Drivetrain("turned", [tn.Inertia("J", node="a", inertia=2)], inputs={"phi": {"angle": "a"}})
    with pytest.raises(tn.UsageError, match="unsupported-law"):
        turned.matrices()
    with pytest.raises(AttributeError, match=r"model.matrices\(\)"):
        _ = controlled(law=1).M


def test_a_notebook_shows_a_table_of_each_by_coordinates():
    shown = tn.load("amt_rig").configured("V").matrices()._repr_html_()
    assert re.findall("<caption>(.*?)</caption>", shown) == ["M [kg*m^2]", "C [N*m*s/rad]", "K [N*m/rad]"]
    assert "input_shaft</td><td>-460</td><td>1617.36</td>" in shown
