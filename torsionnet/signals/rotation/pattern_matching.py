"""First tooth of a record in a stored pitch pattern, found by the shape that its pulses show."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.calibration_windows import order_set, windows_of_test
from torsionnet.signals.rotation.wheel import Wheel, WheelPattern

MATCHED_SHARE = 0.2
"""Share of the number of teeth above which orders are compared: vibration fills those below it."""
LEAST_CORRELATION, LEAST_LEAD = 0.7, 0.2
"""Least correlation of a pattern with a record, and its least lead over the next best tooth: of 60 independent teeth
the best wrong one correlates by about 0.4."""


def first_tooth(name: str, times: FloatArray, numbers: NDArray[np.intp], wheel: Wheel, pattern: WheelPattern) -> int:
    """Tooth of a pattern that the tooth numbered 0 in a record is, found by the shape that the pulses show.

    For records without gap or index pulse. What is compared are orders above those of vibration.

    Parameters
    ----------
    name : str
        Channel, for messages.
    times, numbers : (n,) arrays
        Times of the pulses in s, and their teeth counted on from turn to turn.
    wheel : Wheel
    pattern : WheelPattern

    Raises
    ------
    UsageError
        No tooth fits, or two fit about as well.
    """
    test = windows_of_test(name, times, numbers, None, wheel, order_set(wheel, 2), 0.0, np.zeros(wheel.teeth))
    seen = np.mean([window.first.mean_of_tooth for window in test.windows], axis=0)
    return best_shift(name, pattern.positions, -np.nan_to_num(seen))


def best_shift(name: str, positions: FloatArray, seen: FloatArray) -> int:
    """Tooth of a pattern (teeth,) that is tooth 0 of what a record shows at each tooth, both in rad.

    Raises
    ------
    UsageError
        None fits, or two fit about as well.

    Examples
    --------
    >>> teeth = np.random.default_rng(1).standard_normal(60)
    >>> best_shift("n1", teeth, np.roll(teeth, -7))
    7
    """
    own, other = _compared(positions), _compared(seen)
    size = np.linalg.norm(own) * np.linalg.norm(other)
    # Circular correlation over the teeth, by the product of the spectra, at each shift of one against the other.
    fits = np.fft.irfft(own * other.conj(), len(positions)) * len(positions) / 2 / size if size > 0 else None
    if fits is None:
        raise UsageError(f"{name}: the pattern is the same at every tooth, and says not which is the first")
    best, second = np.argsort(fits)[[-1, -2]]
    if fits[best] < LEAST_CORRELATION or fits[best] - fits[second] < LEAST_LEAD:
        raise UsageError(
            f"{name}: the pattern fits the record by a correlation of {fits[best]:.2f} with its tooth {best} first and "
            f"{fits[second]:.2f} with tooth {second}: which is the first cannot be told; record an index pulse, or "
            "calibrate from this record itself"
        )
    return int(best)


def _compared(values: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Spectrum over the teeth of the orders that are compared; others are 0."""
    found = np.fft.rfft(values)
    found[: int(MATCHED_SHARE * len(values)) + 1] = 0
    if len(values) % 2 == 0:
        found[-1] /= np.sqrt(2)  # half the tooth count stands once in the spectrum of a full turn, others twice
    return np.asarray(found)


# Whether a stored pitch pattern can be that of a wheel.


def check_pattern(name: str, wheel: Wheel, pattern: WheelPattern) -> None:
    """Refuse a pitch pattern that cannot be that of a wheel.

    Raises
    ------
    UsageError
        Other numbers of teeth or of missing teeth, or the other sense of rotation; all of them at once.

    Examples
    --------
    >>> import numpy as np
    >>> check_pattern("n1", Wheel(teeth=60), WheelPattern(np.zeros(60), np.zeros(60)))
    """
    faults = []
    if pattern.teeth != wheel.teeth:
        faults.append(f"a pattern of {pattern.teeth} teeth does not fit a wheel of {wheel.teeth}")
    if pattern.missing != wheel.missing_teeth:
        faults.append(f"the pattern's gap lacks {pattern.missing} teeth, the wheel's {wheel.missing_teeth}")
    if pattern.reversed != wheel.reversed:
        senses = ("in the sense of the model", "against the sense of the model")
        faults.append(
            f"the pattern was calibrated while the wheel turned {senses[pattern.reversed]}, but it turns "
            f"{senses[wheel.reversed]}: the pickup sees the other edges in the other sequence; calibrate in this sense"
        )
    if faults:
        raise UsageError(f"{name}: {'; '.join(faults)}")
