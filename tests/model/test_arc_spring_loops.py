"""Slow loops of arc springs: closed form and march against reference numbers of a component bench, and each other."""

import math

import numpy as np
import pytest

from torsionnet.linear.sensitivity.unknowns import Dual
from torsionnet.model.arc_spring.linear_law import _tangent
from torsionnet.model.arc_spring.loop_at_torque import loop_at_torque
from torsionnet.model.arc_spring.segment_chain import SegmentChain, marched_loop, segments_needed
from torsionnet.model.arc_spring.slow_loop import ArcSprings, closed_loop, loop_from_top

TWENTY = math.radians(20)
TABLE = [
    (0, 0.5, 3601.7217, 0.36571572, 0.424413, 0.389),
    (0, 2, 1760.3076, 2.8598418, 0.424413, 0.799),
    (0, 10, 924.06921, 23.530755, 0.266089, 1),
    (1500, 0.5, 4321.9782, 0.43884994, 0.424413, 0.324),
    (1500, 2, 2109.8417, 3.4277043, 0.424413, 0.666),
    (1500, 10, 1016.4415, 32.087705, 0.329877, 1),
    (3000, 0.5, 6000.9365, 0.60932993, 0.424413, 0.233),
    (3000, 2, 2933.8988, 4.766489, 0.424413, 0.478),
    (3000, 10, 1293.5582, 51.720696, 0.417805, 1),
]
"""Speed in rpm, swing in deg about 20 deg, k_s, loss, eta_s and depth, worked out independently."""


def springs(rpm=3000.0, **given):
    values = {
        "stiffness": 700.0, "arc_angle": 2.6, "friction_coefficient": 0.12, "spring_mass": 0.9, "spring_radius": 0.11,
        "speed": rpm * math.pi / 30,
    }  # fmt: skip
    return ArcSprings(**values | given)


@pytest.mark.parametrize(
    ("rpm", "friction", "torque"), [(0, 0, 284.44301), (1500, 32.243998, 301.402), (3000, 128.97599, 352.27896)]
)
def test_first_loading(rpm, friction, torque):
    one = springs(rpm)
    assert one.friction_coefficient * one.pressure == pytest.approx(friction, rel=1e-7)
    assert one.first_torque(TWENTY) == pytest.approx(torque, rel=2e-8)
    assert one.first_twist(torque) == pytest.approx(TWENTY, rel=2e-8)
    assert one.first_torque(-TWENTY) == -one.first_torque(TWENTY)


@pytest.mark.parametrize(("rpm", "swing", "secant", "loss", "factor", "depth"), TABLE)
def test_closed_loop(rpm, swing, secant, loss, factor, depth):
    loop = closed_loop(springs(rpm), math.radians(swing), TWENTY)
    assert loop.secant_stiffness == pytest.approx(secant, rel=6e-8)
    assert loop.loss == pytest.approx(loss, rel=6e-8)
    assert loop.secant_loss_factor == pytest.approx(factor, abs=6e-7)
    assert loop.depth == pytest.approx(depth, abs=6e-4)


@pytest.mark.parametrize(("rpm", "swing", "secant", "loss", "factor", "depth"), TABLE)
def test_a_march_of_80_segments(rpm, swing, secant, loss, factor, depth):
    del factor, depth
    loop = marched_loop(springs(rpm), math.radians(swing), TWENTY, 80)
    assert loop.secant_stiffness == pytest.approx(secant, rel=4e-4)
    assert loop.loss == pytest.approx(loss, rel=2e-3)


@pytest.mark.parametrize(("rpm", "swing", "secant", "loss", "factor", "depth"), TABLE)
def test_segments_for_one_percent(rpm, swing, secant, loss, factor, depth):
    del factor
    for needed, share in ((segments_needed(depth), "loss"), (segments_needed(depth, math.inf, 0.01), "stiffness")):
        loop = marched_loop(springs(rpm), math.radians(swing), TWENTY, needed)
        found, expected = (loop.loss, loss) if share == "loss" else (loop.secant_stiffness, secant)
        assert found == pytest.approx(expected, rel=0.013), (share, needed)


def test_the_two_loss_factors_differ():
    """While coils are locked eta_1 is 1/2 and k' = 8/(3 pi) k_s; a chain of 20 segments has .492 and 2510."""
    loop = closed_loop(springs(), math.radians(2), TWENTY)
    assert loop.secant_loss_factor == pytest.approx(4 / (3 * math.pi), rel=1e-12)
    assert loop.loss_factor == pytest.approx(0.5, rel=1e-12)
    assert loop.stiffness.real == pytest.approx(8 / (3 * math.pi) * loop.secant_stiffness, rel=1e-12)
    assert loop.stiffness.real == pytest.approx(2490.37, abs=0.005)
    chain = marched_loop(springs(), math.radians(2), TWENTY, 20)
    assert (chain.secant_stiffness, chain.loss) == pytest.approx((2930.2, 4.734), rel=1e-4)
    assert chain.stiffness.real == pytest.approx(2510, abs=0.5)
    assert chain.loss_factor == pytest.approx(0.492, abs=1e-3)


def test_below_the_depth_of_a_segment_a_chain_is_a_stiff_spring():
    """Stiffness 2 n k and no loss, whatever the springs do."""
    loop = marched_loop(springs(), math.radians(0.01), TWENTY, 10)
    assert loop.secant_stiffness == pytest.approx(2 * 10 * 700, rel=1e-9)
    assert loop.loss == pytest.approx(0, abs=1e-9)
    assert loop.mean_torque == pytest.approx((loop.top + loop.bottom) / 2, rel=1e-13)
    assert loop.depth == 0
    assert closed_loop(springs(), math.radians(0.01), TWENTY).loss_factor == pytest.approx(0.5, rel=1e-9)


def test_branches_of_the_march_are_those_of_the_closed_form():
    """Falling from the top of 22 deg: u_t (1 - sqrt(k e x/u_t))^2."""
    one, chain = springs(), SegmentChain(springs(), 400)
    chain.lead(math.radians(22))
    falling = chain.lead(math.radians(18))
    top = one.first_torque(math.radians(22)) + one.base
    x = math.radians(22) - falling.twists
    expected = top * (1 - np.sqrt(700 * one.winding * x / top)) ** 2 - one.base
    np.testing.assert_allclose(falling.torques, expected, rtol=2e-4)


class TestLifting:
    def test_is_left_to_the_march(self):
        """3000 rpm, top torque 50 N m, +-.5 deg."""
        assert loop_from_top(springs(), math.radians(0.5), 50.0) is None
        mean = springs().first_twist(50.0) - math.radians(0.5)
        assert closed_loop(springs(), math.radians(0.5), mean) is None
        loops = [marched_loop(springs(), math.radians(0.5), mean, n) for n in (80, 160, 320)]
        assert [loop.top for loop in loops] == pytest.approx([50.0] * 3, rel=2e-4)
        steps = [abs(one.loss - loops[-1].loss) for one in loops[:-1]]
        assert steps[1] < steps[0]

    def test_without_mean_torque_and_speed_the_springs_are_loaded_from_nothing_each_half_cycle(self):
        """Loaded by u (1 - exp(-e)) = k e gamma, unloaded by u (exp(e) - 1): both are straight lines through zero."""
        one = springs(0)
        loop = loop_at_torque(one, math.radians(2), 0.0)
        e, a = one.winding, math.radians(2)
        rising, falling = 700 * e / -math.expm1(-e), 700 * e / math.expm1(e)
        assert loop.top == pytest.approx(rising * a, rel=1e-3)
        # Half of each cycle rises from rest; unloading begins with a quick fall, so that the loss is below that of
        # the two lines, (rising - falling) a^2.
        assert 0.3 * (rising - falling) * a**2 < loop.loss < (rising - falling) * a**2

    def test_a_flange_that_comes_back_meets_the_springs_where_they_were_left(self):
        chain = SegmentChain(springs(), 20)
        chain.lead(math.radians(20))
        gone = chain.lead(math.radians(2))
        back = chain.lead(math.radians(20))
        assert gone.torques[-1] == 0
        left = gone.twists[np.flatnonzero(gone.torques == 0)[0]]
        np.testing.assert_allclose(back.twists[back.torques > 0][0], back.twists[np.flatnonzero(back.torques)[0]])
        assert back.twists[np.flatnonzero(back.torques)[0] - 1] == pytest.approx(left, rel=1e-12)
        assert back.torques[-1] == pytest.approx(springs().first_torque(math.radians(20)), rel=2e-3)


class TestMeanTorque:
    @pytest.mark.parametrize(("rpm", "swing"), [(0, 2), (1500, 0.5), (3000, 2), (3000, 10), (1500, 10)])
    def test_is_the_mean_over_a_sine_of_the_twist(self, rpm, swing):
        """Read off the march by 1000 times of a cycle."""
        loop = loop_at_torque(springs(rpm), math.radians(swing), 280.0)
        chain = SegmentChain(springs(rpm), 160)
        phases = 2 * np.pi * (np.arange(1000) + 0.5) / 1000
        twists = loop.mean_twist + math.radians(swing) * np.cos(phases)
        chain.lead(loop.mean_twist + math.radians(swing))
        torques = np.array([chain.lead(twist).torques[-1] for twist in [*twists, *twists]][1000:])
        assert torques.mean() == pytest.approx(280, rel=1e-3)
        first = 2 * np.mean(torques * np.exp(-1j * phases)) / math.radians(swing)
        # Under gamma = a cos(w t) a loss is an imaginary part above zero: the torque leads.
        assert complex(first) == pytest.approx(loop.stiffness, rel=3e-3)

    @pytest.mark.parametrize(("friction", "rpm"), [(0.12, 3000), (0.4, 1000)])
    def test_is_none_where_none_is_asked_for(self, friction, rpm):
        """Coils that stay where the first loading left them pull 1.1 and 7.6 N m down about no twist."""
        loop = loop_at_torque(springs(rpm, friction_coefficient=friction), math.radians(2), 0.0)
        assert abs(loop.mean_torque) < 1e-4
        assert loop.mean_twist > 0

    def test_slopes_are_those_of_a_stiffness_that_grows_with_all_forces_alike(self):
        """Stiffness, mass and torque in half as large units: by Euler, sum x dk/dx = k over these three."""
        given = [700.0, 2.6, 0.12, 0.9, 0.11, 100 * math.pi, math.radians(10), 276.2278]
        forces = dict(zip((0, 3, 7), np.eye(3), strict=True))
        numbers = [Dual(value, forces[at]) if at in forces else value for at, value in enumerate(given)]
        for part in _tangent(numbers):
            assert part.gradient @ [given[at] for at in forces] == pytest.approx(part.value, rel=1e-9)

    def test_coast_mirrors_drive(self):
        drive, coast = (loop_at_torque(springs(), 0.02, torque) for torque in (200.0, -200.0))
        assert (coast.top, coast.mean_twist) == (-drive.bottom, -drive.mean_twist)
        assert coast.stiffness == drive.stiffness

    def test_without_friction_the_springs_are_linear(self):
        loop = loop_at_torque(springs(friction_coefficient=0.0), 0.02, 200.0)
        assert (loop.stiffness, loop.loss) == (pytest.approx(700), 0)
