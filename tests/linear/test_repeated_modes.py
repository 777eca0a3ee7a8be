"""Shapes of modes with one frequency: real, each at a node of its own, in the order of the nodes."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.linear.modes.mode_shapes import _nodes_apart


def star(branches, damping=0.0, drag=0.0):
    """Equal branches on a hub: all modes but two have a hub that stands still."""
    parts = [tn.Inertia("hub", node="h", inertia=0.3)]
    for i in range(branches):
        parts += [
            tn.Spring(f"spring_{i}", nodes=("h", f"b{i}"), stiffness=100, damping=damping),
            tn.Inertia(f"disc_{i}", node=f"b{i}", inertia=0.1),
        ]
        parts += [tn.Damper(f"drag_{i}", nodes=(f"b{i}", "ground"), damping=drag)] if drag else []
    return tn.Drivetrain("star", parts)


@pytest.mark.parametrize(("damping", "drag"), [(0.0, 0.0), (0.3, 0.0), (0.3, 0.1), (20.0, 0.0)])
@pytest.mark.parametrize("branches", [3, 5])
def test_equal_branches(branches, damping, drag):
    """lambda^2 J + lambda (c + d) + k = 0 for a branch alone; its shapes are this branch against the others' sum."""
    modes = star(branches, damping, drag).modes()
    roots = np.roots([0.1, damping + drag, 100.0])
    for root in roots[roots.imag >= 0]:
        own = np.flatnonzero(np.abs(modes.eigenvalues - root) < 1e-6 * abs(root))
        assert len(own) == branches - 1
        shapes = modes.shapes[:, own]
        assert np.abs(shapes.imag).max() < 1e-9
        assert np.abs(shapes[0]).max() < 1e-9
        assert np.abs(shapes[1:].sum(axis=0)).max() < 1e-9
        moving = [np.flatnonzero(np.abs(shape) > 1e-9).tolist() for shape in shapes.T]
        assert all(len(nodes) == 2 for nodes in moving)  # one of those chosen, and the one that is not
        assert moving == sorted(moving)
    assert len(modes.notes) == len(roots[roots.imag >= 0])
    assert "share one eigenvalue" in modes.notes[0]


def test_single_modes_have_no_note():
    assert tn.load("dmf_rig").modes().notes == ()


def test_the_note_names_modes_and_nodes():
    modes = tn.load("planetary_set").modes()
    (note,) = modes.notes
    assert note == (
        "modes 1 and 2 share one eigenvalue, so every combination of their shapes is a mode too; shown are those in "
        "which of planet_1 and planet_2 only one moves, in this order"
    )
    assert modes.notes[0] in modes.table().notes


def test_real_poles_that_share_an_eigenvalue_have_no_number():
    """Three equal dampers on a heavy hub: the outer masses decay against their likes at c/J = 2 1/s, twice."""
    elements = [tn.Inertia("hub", node="h", inertia=10), tn.Spring("k", nodes=("h", "ground"), stiffness=1e6)]
    for name in "xyz":
        elements += [
            tn.Inertia(name, node=name, inertia=2),
            tn.Damper(f"c_{name}", nodes=("h", name), damping=4),
        ]
    (note,) = tn.Drivetrain("couplings", elements).modes().notes
    assert note.startswith("2 real poles at -2 rad/s share one eigenvalue")


@pytest.mark.parametrize(("damping", "word"), [(20.0, "critically damped"), (20.001, "overdamped")])
def test_critical_damping_has_its_word(damping, word):
    """s^2 + 20 s + 100 has a double root."""
    spring = tn.Spring("k", nodes=("a", "ground"), stiffness=100, damping=damping)
    modes = tn.Drivetrain("one", [tn.Inertia("j", node="a", inertia=1), spring]).modes()
    assert [text.partition(",")[0] for text in modes.descriptions] == [word, word]


def test_a_double_pole_with_one_shape_stays_as_it_is():
    """Critical damping: one shape for both."""
    rig = tn.Drivetrain(
        "critical",
        [
            tn.Inertia("disc", node="a", inertia=1),
            tn.Spring("spring", nodes=("a", "ground"), stiffness=1, damping=2),
        ],
    )
    modes = rig.modes()
    assert modes.eigenvalues == pytest.approx([-1, -1], abs=1e-6)
    assert modes.notes == ()


def test_the_choice_does_not_depend_on_which_shapes_came_out():
    """Two shapes over five nodes and their combinations; two that are nearly one have no choice."""
    rng = np.random.default_rng(4)
    shapes = rng.normal(size=(5, 2)) + 1j * rng.normal(size=(5, 2))
    chosen = _nodes_apart(shapes)
    for _ in range(20):
        mixed = shapes @ (rng.normal(size=(2, 2)) + 1j * rng.normal(size=(2, 2)))
        assert _nodes_apart(mixed) == chosen
    assert _nodes_apart(np.column_stack([shapes[:, 0], shapes[:, 0] * (1 + 1e-9)])) is None
    assert _nodes_apart(np.ones((1, 2), dtype=complex)) is None
