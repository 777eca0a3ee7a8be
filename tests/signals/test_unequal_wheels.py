"""Two wheels of unequal counts on one shaft: which tooth is which, as on a vernier."""

import numpy as np
import pytest
from support.known_rotation import pulse_times, shaft

from torsionnet.base.errors import UsageError
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.rotations_of_wheels import phase_between, tooth_by_difference
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

_, ANGLE = shaft(100.0, {6: np.radians(0.1)}, acceleration=3.0)


def turning(teeth, mounted, first, draw=None, sigma=0.0):
    """Rotation of a wheel whose tooth 0 stands ``mounted`` rad beyond that of the shaft, from its tooth ``first`` on."""
    numbers = np.arange(teeth + first, 20 * teeth + first)
    errors = 0 if draw is None else sigma * draw.normal(size=teeth)[numbers % teeth]
    times = pulse_times(ANGLE, numbers * 2 * np.pi / teeth + mounted + errors, 3.0)
    return wheel_rotation(PulseChannel(f"z{teeth}", times), Wheel(teeth=teeth))


@pytest.mark.parametrize("first", [0, 17, 59])
def test_the_difference_of_60_and_61_teeth_tells_the_tooth(first):
    draw = np.random.default_rng(first)
    known = phase_between(turning(60, 0.0, 0), turning(61, 0.7, 3))
    # 61 teeth, of which one stands 0.7 rad beyond tooth 0 of the shaft: 0.7 * 61/(2 pi) = 6.796 pitches.
    assert known == pytest.approx(-(0.7 * 61 / (2 * np.pi)) % 1, abs=1e-3)
    found = tooth_by_difference(turning(60, 0.0, first, draw, 1e-4), turning(61, 0.7, 40, draw, 1e-4), known)
    assert found == first


def test_counts_with_a_common_divisor():
    with pytest.raises(UsageError, match=r"(?s)60.*48.*contradicting-values"):
        tooth_by_difference(turning(60, 0.0, 0), turning(48, 0.0, 0), 0.0)


def test_wheels_that_do_not_turn_together():
    with pytest.raises(UsageError, match="drift apart"):
        phase_between(turning(60, 0.0, 0), wheel_rotation(turning_channel(), Wheel(teeth=59)))


def turning_channel():
    return PulseChannel("slow", pulse_times(lambda t: 0.97 * ANGLE(t), np.arange(60, 1100) * 2 * np.pi / 59, 3.0))


def test_a_phase_of_another_assembly():
    first, second = turning(60, 0.0, 0), turning(61, 0.7, 0)
    with pytest.raises(UsageError, match="ambiguous-tooth"):
        tooth_by_difference(first, second, phase_between(first, second) + 0.5 / 60)
