"""Complex orders of a rotating test: of its signals, wheels and twists, with phases from one mark."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from torsionnet.signals.orders.cycle_average import CycleAverage
from torsionnet.signals.orders.mean_rotation import MeanRotation
from torsionnet.signals.orders.phase_reference import phase_reference
from torsionnet.signals.orders.track_orders import track_orders
from torsionnet.signals.orders.tracked_orders import TrackedOrders
from torsionnet.signals.orders.tracked_signals import Twist
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.record_blocks import Recordings
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_rotation import WheelRotation


@dataclass(frozen=True, eq=False)
class PhaseMark:
    """Pulses from which phases count, and the angle from them to where phases are 0.

    Attributes
    ----------
    index : PulseChannel, optional
        Pulses once per turn of the reference shaft; without them tooth 0 of its wheel is the mark.
    cam : PulseChannel, optional
        Pulses once per cycle, which tell the turn that begins it.
    offset : float
        From the mark to where phases are 0, rad.
    place : str
        What is there, as ``"top dead centre of cylinder 1"``.
    of_wheel : bool
        Whether tooth 0 of the wheel is a mark; False where the cam's pulse alone is.

    Examples
    --------
    >>> PhaseMark(offset=0.6, place="top dead centre of cylinder 1").index is None
    True
    """

    index: PulseChannel | None = None
    cam: PulseChannel | None = None
    offset: float = 0.0
    place: str = ""
    of_wheel: bool = True


def orders_of_test(
    recordings: Recordings | None,
    rotations: Mapping[str, WheelRotation],
    mean: MeanRotation,
    *,
    orders: Sequence[float],
    channels: Sequence[str] = (),
    wheels: Sequence[str] = (),
    twists: Sequence[Twist] = (),
    mark: PhaseMark | None = None,
    method: CycleAverage | VoldKalman | None = None,
    further: Sequence[tuple[MeanRotation, Sequence[float]]] = (),
) -> tuple[TrackedOrders, ...]:
    """Complex orders (peaks, SI) of the channels, wheels and twists of a test, in this sequence, with 95 % intervals.

    Parameters
    ----------
    recordings : Recording or blocks of one, optional
        Record of the channels.
    rotations : mapping of str to WheelRotation
        Rotations of all wheels, by name.
    mean : MeanRotation
        Mean rotation of the reference shaft. Where it is that of a wheel, that wheel tells the angle of the marks.
    orders : sequence of float
        Vibrations per revolution of the reference shaft.
    channels, wheels : sequence of str, optional
        Signals of the record, and wheels, that are tracked.
    twists : sequence of Twist, optional
        Between wheels, which they name.
    mark : PhaseMark, optional
    method : CycleAverage or VoldKalman, optional
    further : sequence of (MeanRotation, sequence of float), optional
        Orders of other shafts, as for :func:`track_orders`.

    Raises
    ------
    UsageError
        No mark for the phases asked for, or what :func:`track_orders` refuses.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> from torsionnet.signals.orders.mean_rotation import mean_rotation
    >>> angle = 0.06 * np.arange(20_000)
    >>> record = Recording(
    ...     (Signal("a", "angle", angle), Signal("T", "torque", 5 * np.cos(3 * angle))), sampling_rate=1000
    ... )
    >>> (found,) = orders_of_test(record, {}, mean_rotation(record, "a"), orders=[3], channels=["T"])
    >>> print(abs(found.along(3)).max().round(3))
    5.0
    """
    at = mark or PhaseMark()
    reference = phase_reference(
        mean,
        rotations.get(mean.name),
        index=at.index,
        cam=at.cam,
        offset=at.offset,
        place=at.place,
        wheel_has_mark=at.of_wheel,
    )
    return track_orders(
        recordings, mean, channels, [rotations[name] for name in wheels],
        [(twist, rotations[twist.first], rotations[twist.second]) for twist in twists],
        orders=orders, method=method, reference=reference, further=further,
    )  # fmt: skip
