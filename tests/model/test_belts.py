"""Belts and chains against gears of the same drive, and against matrices written by hand."""

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.model.elements import Values

R1, R2, K1, K2 = 0.08, 0.03, 4e5, 2.5e5


def drive(element, housing=False):
    masses = [("a", 0.4), ("b", 0.02), *([("c", 1.5)] if housing else [])]
    return tn.Drivetrain(
        "drive",
        [
            element,
            *(tn.Inertia(f"J_{node}", node=node, inertia=inertia) for node, inertia in masses),
            tn.Spring("load", nodes=("b", "ground"), stiffness=90, damping=0.05),
            *([tn.Spring("mount", nodes=("c", "ground"), stiffness=900)] if housing else []),
        ],
        inputs={"T": {"torque": "a"}},
        sensors={"b": {"angle": "b"}, "T_b": {"torque": element.name, "at": "b"}},
    )


def same(one, other):
    np.testing.assert_allclose(one.modes().eigenvalues, other.modes().eigenvalues, rtol=1e-12, atol=1e-12)
    found, expected = (rig.frequency_response(["b", "T_b"], "T", [0.7, 8.0, 90.0]).values for rig in (one, other))
    np.testing.assert_allclose(found, expected, rtol=1e-11)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("housing", [False, True])
class TestTwoWheelsAreAGear:
    def on(self, housing):
        return {"housing": "c"} if housing else {}

    def test_rigid(self, side, housing):
        belt = tn.Belt("x", pulleys={"a": R1, "b": side * R2}, **self.on(housing))
        gear = tn.Gear("x", nodes=("a", "b"), ratio=side * R2 / R1, **self.on(housing))
        same(drive(belt, housing), drive(gear, housing))

    def test_elastic_spans_in_parallel(self, side, housing):
        """k = (k_1 + k_2) r_1^2, and with the damping of both spans."""
        belt = tn.Belt("x", pulleys={"a": R1, "b": side * R2}, stiffness=[K1, K2], damping=1.5, **self.on(housing))
        more = {"stiffness": (K1 + K2) * R1**2, "damping": 3, **self.on(housing)}
        same(drive(belt, housing), drive(tn.Gear("x", nodes=("a", "b"), ratio=side * R2 / R1, **more), housing))

    def test_lengths_and_strain(self, side, housing):
        pulleys = {"a": R1, "b": side * R2}
        by_length = tn.Belt("x", pulleys=pulleys, axial_stiffness=1e5, lengths=[0.25, 0.4], **self.on(housing))
        same(
            drive(by_length, housing),
            drive(tn.Belt("x", pulleys=pulleys, stiffness=[K1, K2], **self.on(housing)), housing),
        )

    def test_chains(self, side, housing):
        chain = tn.ChainDrive("x", sprockets={"a": 40, "b": side * 15}, **self.on(housing))
        same(
            drive(chain, housing),
            drive(tn.Gear("x", nodes=("a", "b"), teeth=(40, side * 15), **self.on(housing)), housing),
        )
        pitch = 2 * np.pi * R1 / 40
        elastic = tn.ChainDrive(
            "x", sprockets={"a": 40, "b": side * 15}, pitch=pitch, stiffness=[K1, K2], **self.on(housing)
        )
        belt = tn.Belt("x", pulleys={"a": R1, "b": side * R2}, stiffness=[K1, K2], **self.on(housing))
        same(drive(elastic, housing), drive(belt, housing))


def test_three_pulleys_and_a_tensioner_against_their_matrix():
    """Beikmann, Perkins and Ulsoy: every span stretches by what its ends and the arm do."""
    radii, spans, levers = np.array([0.09, 0.05, -0.04]), np.array([3e5, 2e5, 4e5]), (0.07, -0.02)
    inertias, arm, spring = np.array([0.2, 0.01, 0.004]), 0.003, 40.0
    stretch = np.array(
        [
            [-radii[0], radii[1], 0, 0],
            [0, -radii[1], radii[2], levers[0]],
            [radii[0], 0, -radii[2], levers[1]],
        ]
    )
    stiffness = stretch.T @ np.diag(spans) @ stretch + np.diag([0, 0, 0, spring])
    squares = np.linalg.eigvals(stiffness / np.array([*inertias, arm])[:, None])
    expected = np.sqrt(np.sort(squares.real)[1:]) / (2 * np.pi)
    pulleys = dict(zip("abc", radii.tolist(), strict=True))
    rig = tn.Drivetrain(
        "accessories",
        [
            tn.Belt("belt", pulleys=pulleys, stiffness=spans.tolist(), tensioner="c", arm="d", levers=levers),
            *(tn.Inertia(f"J_{node}", node=node, inertia=float(j)) for node, j in zip("abc", inertias, strict=True)),
            tn.Inertia("arm", node="d", inertia=arm),
            tn.Spring("spring", nodes=("d", "ground"), stiffness=spring),
        ],
    )
    found = np.sort(rig.modes().natural_frequencies)
    assert found[0] == 0
    np.testing.assert_allclose(found[1:], expected, rtol=1e-10)


def test_a_chain_keeps_exact_ratios():
    rig = tn.Drivetrain(
        "timing",
        [
            tn.ChainDrive("chain", sprockets={"crank": 21, "cam": 42, "pump": 19}),
            *(tn.Inertia(node, node=node, inertia=1) for node in ("crank", "cam", "pump")),
        ],
    )
    assert rig.ratio_between("crank", "cam") == 2
    assert rig.ratio_between("pump", "crank") == pytest.approx(21 / 19, rel=1e-15)


def test_parameters_and_the_way_through_a_file():
    text = """torsionnet: 1
name: belt
parameters: {r: 80 mm, EA: 100 kN}
elements:
  belt: {type: belt, pulleys: {a: r, b: -r/2}, axial_stiffness: EA, lengths: [0.25 m, 0.4 m], pretension: 300 N}
  one: {type: inertia, node: a, inertia: 0.4}
  two: {type: inertia, node: b, inertia: 0.02}
"""
    rig = tn.loads(text)
    assert tn.loads(rig.to_yaml()) == rig
    referred = 0.02 * 4
    stiffness = 1e5 * (1 / 0.25 + 1 / 0.4) * 0.08**2
    expected = np.sqrt(stiffness * (1 / 0.4 + 1 / referred)) / (2 * np.pi)
    assert max(rig.modes().natural_frequencies) == pytest.approx(expected, rel=1e-12)
    assert max(rig.configured(EA=4e5).modes().natural_frequencies) == pytest.approx(2 * expected, rel=1e-12)


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"stiffness": [1e5]}, r"elements\.belt\.stiffness: .*wrong-form"),
        ({"stiffness": [1e5, 1e5, 1e5]}, r"elements\.belt\.stiffness: .*wrong-count"),
        ({"stiffness": [1e5, "3 N*m/rad"]}, r"elements\.belt\.stiffness\.1: .*wrong-unit"),
        ({"axial_stiffness": 1e5}, "missing-entry"),
        ({"lengths": [1, 1]}, "missing-entry"),
        (
            {"stiffness": [1, 1], "axial_stiffness": 1, "lengths": [1, 1]},
            r"elements\.belt\.axial_stiffness: .*contradicting-entries",
        ),
        ({"damping": 3}, r"elements\.belt\.damping: .*missing-entry"),
        ({"arm": "d"}, r"elements\.belt\.arm: .*missing-entry"),
        ({"tensioner": "z", "arm": "d", "levers": [1, 1]}, r"elements\.belt\.tensioner: .*unknown-node"),
        ({"tensioner": "b", "arm": "d", "levers": [1, 1]}, r"elements\.belt\.levers: .*wrong-count"),
        ({"housing": "a"}, r"elements\.belt\.pulleys: .*same-node"),
        ({"pulleys": {"a": 0.1}}, r"elements\.belt\.pulleys: .*wrong-form"),
    ],
)
def test_what_is_wrong_is_said(entries, words):
    with pytest.raises(tn.ModelError, match=words):
        tn.Belt("belt", **{"pulleys": {"a": 0.1, "b": 0.2}, **entries})


def test_what_is_wrong_with_a_chain_is_said():
    with pytest.raises(tn.ModelError, match=r"elements\.chain\.sprockets\.a: .*not-a-number"):
        tn.ChainDrive("chain", sprockets={"a": 20.5, "b": 30})
    with pytest.raises(tn.ModelError, match="give pitch"):
        tn.ChainDrive("chain", sprockets={"a": 20, "b": 30}, stiffness=[1e5, 1e5])


def test_rows_are_exact():
    (row,) = (part.row for part in tn.ChainDrive("c", sprockets={"a": 3, "b": 7}).parts(Values({})))
    assert row == {"a": 1, "b": -tn.Gear("g", nodes=("a", "b"), teeth=(3, 7)).ratio_value({})}
