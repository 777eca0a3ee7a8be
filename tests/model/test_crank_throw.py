"""A throw of a crankshaft: stiffness against a frame of beams in space, inertia against the motion of a piston."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

G, E = 79.3e9, 206e9
SHAPE = {
    "journal_diameter": 0.09, "journal_length": 0.05, "pin_diameter": 0.08, "pin_length": 0.06, "web_width": 0.12,
    "web_thickness": 0.03, "crank_radius": 0.065,
}  # fmt: skip


def throw(**given):
    return tn.CrankThrow("throw", nodes=("a", "b"), **{"inertia": 0.03} | given)


def stiffness(**given):
    return float(throw(**given).parts(Values({}))[0].stiffness)


def beam(first, second, *, torsion, across, along):
    """Stiffness (12, 12) of a slender beam: G I_p, E I about the shaft's axis z (or y), and about the other axis."""
    axis = np.subtract(second, first)
    length = np.linalg.norm(axis)
    x = axis / length
    z = np.array([0.0, 0.0, 1.0]) if abs(x[2]) < 0.5 else np.array([0.0, 1.0, 0.0])
    turn = np.kron(np.eye(4), np.array([x, np.cross(z, x), z]))
    local = np.zeros((12, 12))
    for place, rigidity in ((0, 1e12), (3, torsion)):
        local[np.ix_([place, place + 6], [place, place + 6])] = rigidity / length * np.array([[1, -1], [-1, 1]])
    for places, sign, rigidity in (((1, 5, 7, 11), 1, across), ((2, 4, 8, 10), -1, along)):
        a, b = 6 * sign / length**2, 12 / length**3
        block = np.array(
            [[b, a, -b, a], [a, 4 / length, -a, 2 / length], [-b, -a, b, -a], [a, 2 / length, -a, 4 / length]]
        )
        local[np.ix_(places, places)] = rigidity * block
    return turn.T @ local @ turn


def framed_stiffness(shape):
    """Torque over twist of half journal, web, pin, web, half journal: one end clamped, nothing else held."""
    half, r, pin = shape["journal_length"] / 2, shape["crank_radius"], shape["pin_length"]
    points = [(0, 0, 0), (0, 0, half), (r, 0, half), (r, 0, half + pin), (0, 0, half + pin), (0, 0, 2 * half + pin)]

    def round_bar(diameter):
        area = np.pi * diameter**4 / 64
        return {"torsion": 2 * G * area, "across": E * area, "along": E * area}

    width, thickness = shape["web_width"], shape["web_thickness"]
    web = {"torsion": 1e6, "across": E * thickness * width**3 / 12, "along": E * width * thickness**3 / 12}
    journal, crank_pin = round_bar(shape["journal_diameter"]), round_bar(shape["pin_diameter"])
    whole = np.zeros((36, 36))
    for place, section in enumerate((journal, web, crank_pin, web, journal)):
        part = slice(6 * place, 6 * place + 12)
        whole[part, part] += beam(points[place], points[place + 1], **section)
    load = np.zeros(30)
    load[-1] = 1.0
    return 1 / np.linalg.solve(whole[6:, 6:], load)[-1]


def test_stiffness_is_that_of_a_frame_of_beams():
    assert stiffness(**SHAPE) == pytest.approx(framed_stiffness(SHAPE), rel=1e-6)


def test_a_crank_without_radius_is_a_stepped_shaft():
    plain = SHAPE | {"crank_radius": 0, "journal_bore": 0.03, "pin_bore": 0.02}
    polar = [np.pi * (D**4 - d**4) / 32 for D, d in ((0.09, 0.03), (0.08, 0.02))]
    assert stiffness(**plain) == pytest.approx(G / (0.05 / polar[0] + 0.06 / polar[1]), rel=1e-12)


@pytest.mark.parametrize("ratio", [0.2, 0.35])
def test_piston_counts_by_its_mean_square_speed(ratio):
    """Exact motion x = r cos(phi) + sqrt(l^2 - r^2 sin(phi)^2); what is left out is of the order lambda^4."""
    r = 0.06
    phi = np.arange(4096) * 2 * np.pi / 4096
    way = -r * np.sin(phi) - r**2 * np.sin(phi) * np.cos(phi) / np.sqrt((r / ratio) ** 2 - r**2 * np.sin(phi) ** 2)
    turning = throw(crank_radius=r, rod_length=r / ratio, reciprocating_mass=1.6, rotating_mass=1.2, stiffness=1).parts(
        Values({})
    )[1]
    expected = 0.03 + 1.2 * r**2 + 1.6 * np.mean(way**2)
    assert float(turning.inertia) == pytest.approx(expected, abs=1.6 * r**2 * ratio**4 / 10)


def test_a_chain_of_throws_is_the_chain_of_its_parts():
    def rig(*parts):
        wheel = tn.Inertia("wheel", node="w", inertia=2)
        return tn.Drivetrain("crank", [*parts, wheel]).modes()

    nodes = ["c1", "c2", "c3", "w"]
    given = {"stiffness": 1e6, "damping": 40, "cylinder_damping": 3}
    throws = rig(*(tn.CrankThrow(f"t{i}", nodes=nodes[i : i + 2], inertia=0.05, **given) for i in range(3)))
    parts = rig(
        *(tn.Inertia(f"j{i}", node=nodes[i], inertia=0.05) for i in range(3)),
        *(tn.Spring(f"k{i}", nodes=nodes[i : i + 2], stiffness=1e6, damping=40) for i in range(3)),
        *(tn.Damper(f"c{i}", nodes=(nodes[i], "ground"), damping=3) for i in range(3)),
    )
    assert throws.eigenvalues == pytest.approx(parts.eigenvalues, rel=1e-10)


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({}, r"elements\.throw: .*missing-entry"),
        (SHAPE | {"pin_length": None}, r"elements\.throw: .*missing-entry"),
        (SHAPE | {"stiffness": 1e6}, r"elements\.throw\.journal_diameter: .*needless-entry"),
        ({"stiffness": 1e6, "reciprocating_mass": 2}, r"elements\.throw\.reciprocating_mass: .*missing-entry"),
        ({"stiffness": 1e6, "rod_length": 0.2}, r"elements\.throw\.rod_length: .*missing-entry"),
        (
            {"stiffness": 1e6, "rod_length": 0.05, "crank_radius": 0.06},
            r"elements\.throw\.rod_length: .*contradicting-values",
        ),
        (SHAPE | {"pin_bore": 0.08}, r"elements\.throw\.pin_bore: .*contradicting-values"),
    ],
)
def test_what_is_wrong_is_said(given, what):
    with pytest.raises(tn.ModelError, match=what):
        throw(**given)
