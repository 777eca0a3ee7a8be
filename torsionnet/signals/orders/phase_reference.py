"""Reference of phases: the angle of rotation is 0 at the top dead centre of a cylinder, or at a pulse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_rotation import WheelRotation

LARGEST_SPREAD = np.radians(10)
"""Standard deviation of the angles at which pulses come above which they do not come once in each turn: play and
vibration of a shaft stay below it."""
FIRST_PULSE = "the tooth of the first pulse"
"""Name of tooth 0 of a wheel that has no mark, in the words of its rotation."""
CLOSEST_CAM = np.radians(5)
"""Angle between the cam's pulse and the mark up to which their order is left to chance: a cam turns with play."""


@dataclass(frozen=True)
class PhaseReference:
    """Angle of the reference shaft at which phases count from 0.

    Attributes
    ----------
    angle : float
        Mean angle of rotation at which it is 0, rad.
    words : str
        Where that is, in words; empty where it is only the begin of the record.
    turn_known : bool
        Whether it is known which turn of a cycle of several begins there. Else the sign of half orders is not known,
        and their phase is withheld.
    notes : tuple of str

    Examples
    --------
    >>> PhaseReference(0.5, "top dead centre of cylinder 1").turn_known
    True
    """

    angle: float = 0.0
    words: str = ""
    turn_known: bool = True
    notes: tuple[str, ...] = ()


def phase_reference(
    mean: MeanRotation,
    wheel: WheelRotation | None = None,
    *,
    index: PulseChannel | None = None,
    cam: PulseChannel | None = None,
    offset: float = 0.0,
    place: str = "",
    wheel_has_mark: bool = True,
) -> PhaseReference:
    """Phase reference of a record from a mark on the shaft: tooth 0 of a wheel with a gap, or the pulse of an index.

    Parameters
    ----------
    mean : MeanRotation
    wheel : WheelRotation, optional
        The wheel that the mean rotation was read from; its angle at the pulses of index and cam counts, with the
        vibration that shifts them.
    index : PulseChannel, optional
        Pulses once in each turn; takes the place of tooth 0.
    cam : PulseChannel, optional
        Pulses once in each cycle; the first mark after it begins the cycle. Without index and without a gap it is the
        mark itself.
    offset : float, optional
        Angle of the reference shaft from the mark to where phases count from 0, rad.
    place : str, optional
        What is there, as ``"top dead centre of cylinder 1"``.
    wheel_has_mark : bool, optional
        False leaves out tooth 0 of the wheel, as where the cam's pulse alone is the mark.

    Raises
    ------
    UsageError
        No mark, pulses that do not come once in a turn or cycle, or a cam's pulse at the mark.
    """
    turn = 2 * np.pi
    whole = turn * mean.cycle
    gap = wheel_has_mark and wheel is not None and wheel.zero != FIRST_PULSE
    if index is None and cam is None and not gap:
        if offset or place:
            raise UsageError(
                f"{mean.name} has no mark that tells its angle from turn to turn: for phases name a channel of pulses "
                "once per turn (--phase CHANNEL) or per cycle (--cam CHANNEL), or take a wheel with a gap"
            )
        return PhaseReference(float(mean.angles[0]), "")
    mark, said = 0.0, f"{wheel.zero} of {mean.name}" if wheel is not None else mean.name
    notes: list[str] = []
    if index is not None:
        mark, spread = _mean_angle(_angles_at(index, mean, wheel), turn, f"{index.name} as index")
        said, notes = (
            f"the pulse of {index.name}",
            [f"pulses of {index.name} lie within {np.degrees(spread):.2g} deg of their mean angle"],
        )
    known = mean.cycle == 1
    if cam is not None:
        at, spread = _mean_angle(_angles_at(cam, mean, wheel), whole, f"{cam.name} as cam pulse")
        notes.append(f"pulses of {cam.name} lie within {np.degrees(spread):.2g} deg of their mean angle")
        if index is None and not gap:
            mark, said = at, f"the pulse of {cam.name}"
        else:
            # The cam comes once in a cycle, the mark in each turn: that mark begins the cycle which follows the cam.
            after = (mark - at) % turn
            # Where both come nearly together, scatter decides which is first.
            if min(after, turn - after) < max(CLOSEST_CAM, 3 * spread):
                raise UsageError(
                    f"{cam.name} comes {np.degrees(min(after, turn - after)):.2g} degrees from {said}: which of the "
                    "two is first cannot be told; take another index, or shift one of them"
                )
            mark, said = at + after, f"{said}, the first after {cam.name}"
        known = True
    if not known:
        notes.append("which turn of the cycle begins there is not known: phases of half orders are withheld")
    shift = f"{np.degrees(offset):.6g} deg after {said}" if offset else said
    words = f"{place}, {shift}" if place else shift
    return PhaseReference(float(mark + offset), words, known, tuple(notes))


def _angles_at(pulses: PulseChannel, mean: MeanRotation, wheel: WheelRotation | None) -> FloatArray:
    times = pulses.times
    begin, end = mean.ends[0], mean.ends[-1]
    if wheel is not None:
        begin, end = max(begin, wheel.times[0]), min(end, wheel.times[-1])
    times = times[(times >= begin) & (times <= end)]
    if not len(times):
        raise UsageError(f"{pulses.name} has no pulse while {mean.name} turns: are both on one clock?")
    return mean.angle(times) if wheel is None else wheel.angle(times)


def _mean_angle(angles: FloatArray, period: float, name: str) -> tuple[float, float]:
    """Mean and standard deviation in rad of the angles of pulses that come once in each period."""
    # Mean and deviation on the circle: of R = |mean exp(j phi)| the deviation is sqrt(-2 ln R).
    turning = np.exp(2j * np.pi * angles / period).mean()
    spread = float(np.sqrt(abs(2 * np.log(max(abs(turning), 1e-300)))) * period / (2 * np.pi))
    # As many pulses as periods, within a tenth.
    counted = len(angles) / max((angles[-1] - angles[0]) / period + 1, 1)
    if spread > LARGEST_SPREAD or not 0.9 < counted < 1.1:
        raise UsageError(
            f"{name}: its pulses come {counted:.3g} times in {np.degrees(period):.0f} degrees of the reference shaft, "
            f"within {np.degrees(spread):.2g} degrees, and should come once: name the channel of an index or cam pulse"
        )
    return float(np.angle(turning) * period / (2 * np.pi)), spread
