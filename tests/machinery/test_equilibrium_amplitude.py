"""Equilibrium amplitudes and damping shares at critical speeds, against closed forms and dense matrices."""

import math

import numpy as np
import pytest
from support.running_plants import two_mass

import torsionnet as tn
from torsionnet.machinery.orders.operating_groups import damping_shares

CHAIN = (3.0, 5.0, 2.0, 8.0)
"""Inertias of a chain of four discs in kg m^2."""
SPRINGS = (2e4, 5e4, 3e4)
"""Stiffnesses between them in N m/rad."""
TORQUES = {1: 40.0, 2: -25.0}
"""Amplitude of order 3 in N m by the index of the disc."""


def chain(dampings=(0.0, 0.0, 0.0)):
    discs = [tn.Inertia(f"d{n}", node=f"n{n}", inertia=inertia) for n, inertia in enumerate(CHAIN)]
    shafts = [
        tn.Spring(f"s{n}", nodes=(f"n{n}", f"n{n + 1}"), stiffness=k, damping=c)
        for n, (k, c) in enumerate(zip(SPRINGS, dampings, strict=True))
    ]
    excitations = {
        f"t{n}": {"type": "harmonic", "node": f"n{n}", "orders": {3: {"amplitude": abs(size)}}}
        for n, size in TORQUES.items()
    }
    return tn.Drivetrain(
        "chain", [*discs, *shafts], speeds={"of": "n0", "list": ["100 rpm", "900 rpm"]}, excitations=excitations
    )


def dense(dampings=(0.0, 0.0, 0.0)):
    """M, C and K of the chain."""
    rows = np.eye(4)[:3] - np.eye(4)[1:]
    return np.diag(CHAIN), rows.T @ np.diag(dampings) @ rows, rows.T @ np.diag(SPRINGS) @ rows


class TestTwoMasses:
    """One degree of freedom for the twist: static twist 10 N m * (2/3) / k."""

    def test_twist_at_rest(self):
        found = two_mass(damping=0.0).critical_speeds().of(1, 2)
        twist = 1.5 * found.equilibrium_amplitude  # the shape is 1 at the smaller disc, -0.5 at the larger
        assert found.modal_inertia == pytest.approx(1 + 2 * 0.25)
        assert twist == pytest.approx(10 * (2 / 3) / 1e4, rel=1e-12)
        assert found.resonant_amplitude == math.inf

    @pytest.mark.parametrize("zeta", [0.002, 0.02])
    def test_resonance_is_the_equilibrium_amplitude_magnified(self, zeta):
        plant = two_mass(damping=2 * zeta * math.sqrt(1e4 * 2 / 3))
        found = plant.critical_speeds("twist(shaft)").of(1, 2)
        (peak,) = found.peaks
        assert 1.5 * found.resonant_amplitude == pytest.approx(peak.amplitude, rel=zeta**2)


class TestChain:
    @pytest.mark.parametrize("mode", [1, 2, 3])
    @pytest.mark.parametrize(("name", "place"), [("t1", 1), ("t2", 2)])
    def test_is_the_modal_part_of_the_static_deflection(self, mode, name, place):
        """phi phi^T T / (omega^2 phi^T M phi) at the disc that moves most, by a dense eigenvalue problem."""
        M, _, K = dense()
        values, shapes = np.linalg.eigh(K / np.sqrt(np.outer(CHAIN, CHAIN)))
        shape = shapes[:, mode] / np.sqrt(CHAIN)
        shape /= shape[np.abs(shape).argmax()]
        expected = abs(shape[place] * TORQUES[place]) / (values[mode] * shape @ M @ shape)
        found = chain().critical_speeds(speeds=np.array([10.0, 200.0])).of(mode, 3, name)
        assert found.equilibrium_amplitude == pytest.approx(expected, rel=1e-9)

    def test_a_frequency_without_a_torque_has_none(self):
        found = chain().critical_speeds(line_frequency=15, reach=0.9)
        blank = next(one for one in found.crossings if one.fixed)
        assert math.isnan(blank.equilibrium_amplitude)


class TestDampingShares:
    DAMPINGS = (3.0, 1.0, 6.0)

    @pytest.mark.parametrize("mode", [1, 2, 3])
    def test_shares_of_the_dissipated_power(self, mode):
        """c |d gamma|^2 of every shaft over their sum, by the eigenvectors of the dense state matrix."""
        M, C, K = dense(self.DAMPINGS)
        state = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
        values, vectors = np.linalg.eig(state)
        places = [at for at in np.argsort(np.abs(values)) if values[at].imag > 1]
        shape = vectors[:4, places[mode - 1]]
        power = np.array(self.DAMPINGS) * np.abs(np.diff(shape)) ** 2
        rig = chain(self.DAMPINGS)
        critical = rig.critical_speeds(speeds=np.array([10.0, 200.0])).of(mode, 3, "t1")
        found = damping_shares(rig, critical)
        assert list(found) == [f"s{n}" for n in np.argsort(-power)]
        assert list(found.values()) == pytest.approx(np.sort(power / power.sum())[::-1], rel=1e-9)

    def test_without_damping_there_are_none(self):
        assert damping_shares(chain(), chain().critical_speeds(speeds=np.array([10.0, 200.0])).of(1, 3, "t1")) == {}

    @pytest.mark.parametrize("rpm", [400, 800])
    def test_damping_that_follows_the_speed_is_that_at_the_critical_speed(self, rpm):
        """Damper c = T/n beside a fixed one: its share falls as the critical speed rises."""
        omega = rpm * math.pi / 30
        rig = tn.Drivetrain(
            "wheel",
            [
                tn.Inertia("disc", node="a", inertia=1.0),
                tn.Spring("shaft", nodes=("a", "ground"), stiffness=omega**2, damping=0.01),
                tn.Damper("water", nodes=("a", "ground"), damping="c_w"),
            ],
            parameters={"T_w": "1 N*m", "c_w": "T_w/n", "n": {"by": "speed", "of": "a"}},
            operating_point={"speed": {"a": "1000 rpm"}},
            speeds={"of": "a", "list": ["300 rpm", "900 rpm"]},
            excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": 1}}}},
        )
        share = (1 / omega) / (1 / omega + 0.01)
        found = damping_shares(rig, rig.critical_speeds().of(1, 1))
        assert found == pytest.approx({"water": share, "shaft": 1 - share}, rel=1e-6)

    @pytest.mark.parametrize(("asked", "given"), [("wheel", "pinion"), (None, "wheel"), (None, "pinion")])
    def test_whichever_node_the_speed_belongs_to(self, asked, given):
        """A damper c = T/n on a wheel that turns three times as slowly as the first node, the pinion."""
        omega = 90.0
        rig = tn.Drivetrain(
            "geared fan",
            [
                tn.Gear("gear", nodes=("pinion", "wheel"), ratio=3),
                tn.Inertia("disc", node="wheel", inertia=1.0),
                tn.Spring("shaft", nodes=("wheel", "ground"), stiffness=omega**2, damping=0.01),
                tn.Damper("water", nodes=("wheel", "ground"), damping="T_w/n"),
            ],
            parameters={"T_w": "1 N*m", "n": {"by": "speed", "of": "wheel"}},
            operating_point={"speed": {"wheel": "1000 rpm"}},
            speeds={"of": given, "list": ["200 rpm", "1500 rpm"]},
            excitations={"blades": {"type": "harmonic", "node": "wheel", "orders": {1: {"amplitude": 1}}}},
        )
        speed = omega * {"wheel": 1, "pinion": 3}[asked or given]
        critical = rig.critical_speeds(speed_of=asked, speeds=np.array([0.5, 1.5]) * speed).crossings[0]
        assert critical.natural_speed == pytest.approx(speed, rel=1e-6)
        share = (1 / omega) / (1 / omega + 0.01)
        found = damping_shares(rig, critical, reference=asked)
        assert found == pytest.approx({"water": share, "shaft": 1 - share}, rel=1e-6)
