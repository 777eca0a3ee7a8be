"""Complex orders of the signals of a turning machine, by averages over cycles or by Vold-Kalman filters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.signals.orders.cycle_average import CycleAverage, averaged_blocks, half_widths, whole_multiples
from torsionnet.signals.orders.filtered_orders import filtered_orders
from torsionnet.signals.orders.mean_rotation import MeanRotation, PhaseReference, mean_rotation, phase_reference
from torsionnet.signals.orders.tracked_orders import TrackedOrders, TrackingKernel
from torsionnet.signals.orders.tracked_signals import (
    RecordWindow,
    Tracked,
    Twist,
    of_record,
    of_twist,
    of_wheel,
    tracked_values,
)
from torsionnet.signals.orders.vold_kalman import VoldKalman
from torsionnet.signals.recording import FloatArray
from torsionnet.signals.resampling import Recordings
from torsionnet.signals.rotation.pulse_channel import PulseChannel
from torsionnet.signals.rotation.wheel_rotation import WheelRotation


def track_orders(
    recordings: Recordings | None,
    rotation: WheelRotation | MeanRotation,
    channels: Sequence[str] = (),
    wheels: Sequence[WheelRotation] = (),
    twists: Sequence[tuple[Twist, WheelRotation, WheelRotation]] = (),
    *,
    orders: Sequence[float],
    method: CycleAverage | VoldKalman | None = None,
    phase_reference: PhaseReference | None = None,
    further: Sequence[tuple[MeanRotation, Sequence[float]]] = (),
) -> tuple[TrackedOrders, ...]:
    """Complex orders of signals and of the vibration of wheels over time and speed, with 95 % intervals.

    Parameters
    ----------
    recordings : Recording or blocks of one, optional
        Record of the channels. Blocks are read one after the other and dropped.
    rotation : WheelRotation or MeanRotation
        Rotation of the reference shaft.
    channels : sequence of str, optional
        Signals of the record.
    wheels : sequence of WheelRotation, optional
        Wheels whose vibration is tracked, each in the angle of its own shaft, rad.
    twists : sequence of (Twist, WheelRotation, WheelRotation), optional
        Twist between two wheels, or torque from twist, that is tracked.
    orders : sequence of float
        Vibrations per revolution of the reference shaft.
    method : CycleAverage or VoldKalman, optional
        Averages over blocks of eight cycles by default.
    phase_reference : PhaseReference, optional
        Where phases are 0; without one they count from the begin of the record and are not for comparison.
    further : sequence of (MeanRotation, sequence of float), optional
        Orders of other shafts that are tracked together with these, by Vold-Kalman filters only.

    Returns
    -------
    tuple of TrackedOrders
        One for each channel and wheel; behind them, those of further shafts.

    Raises
    ------
    UsageError
        An order above half the teeth of a wheel or half the sampling rate, below one in a cycle, or none; the record
        and the rotation share no two cycles.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> time = np.arange(20_000) / 1000
    >>> angle = 60 * time + 0.5 * time**2
    >>> record = Recording(
    ...     (Signal("a", "angle", angle), Signal("T", "torque", 5 * np.cos(3 * angle + 1))), sampling_rate=1000
    ... )
    >>> (orders,) = track_orders(record, mean_rotation(record, "a"), ["T"], orders=[3, 4.5])
    >>> print(abs(orders.along(3)).min().round(3), abs(orders.along(3)).max().round(3))
    5.0 5.0
    """
    chosen = method or CycleAverage()
    mean = rotation if isinstance(rotation, MeanRotation) else mean_rotation(rotation)
    wanted = np.unique(np.asarray(orders, dtype=np.float64))
    _check_orders(wanted, [*wheels, *(wheel for _, *pair in twists for wheel in pair)])
    zero = phase_reference or PhaseReference(float(mean.angles[0]), "")
    tracked: list[TrackedOrders] = []
    kinds = [of_wheel(wheel, mean) for wheel in wheels]
    kinds += [of_twist(first, second, twist, mean) for twist, first, second in twists]
    if channels:
        assert recordings is not None
        kinds.insert(0, of_record(RecordWindow(recordings, channels), wanted))
        for shaft, its in ((mean, wanted), *further):
            _check_sampling(kinds[0], shaft, max(its, default=0))
    behind: list[TrackedOrders] = []
    for kind in kinds:
        if isinstance(chosen, VoldKalman):
            shafts = [(mean, wanted), *((shaft, np.unique(np.asarray(more, float))) for shaft, more in further)]
            first, *others = filtered_orders(kind, shafts, chosen, zero)
            tracked += first
            behind += [each for other in others for each in other]
        else:
            if further:
                raise UsageError(
                    "orders of further shafts are told apart by Vold-Kalman filters only", kind="unsupported-law"
                )
            tracked += averaged_orders(kind, mean, wanted, chosen, zero)
    return without_lost_times([*tracked, *behind])


def without_lost_times(orders: Sequence[TrackedOrders]) -> tuple[TrackedOrders, ...]:
    """Orders without the times at which one of them has no values, so that all keep common times.

    Raises
    ------
    UsageError
        No time is left.
    """
    lost = [(tracked.name, tracked.times[np.isnan(tracked.values).any(axis=0)]) for tracked in orders]
    if not any(len(times) for _, times in lost):
        return tuple(orders)
    notes = tuple(
        f"{len(times)} of the values of each order left out, the first at {times[0]:.6g} s, as {name} dropped out for "
        "as long as they last" for name, times in lost if len(times)
    )  # fmt: skip
    every = np.concatenate([times for _, times in lost])
    common = []
    for tracked in orders:
        kept = ~np.isin(tracked.times, every)
        if not kept.any():
            raise UsageError(f"{tracked.name}: {'; '.join(notes)}: no value is left", kind="missing-data")
        half = None if tracked.half_range is None else tracked.half_range[kept]
        values, widths = tracked.values[:, kept], tracked.half_widths[:, kept]
        common.append(replace(tracked, times=tracked.times[kept], speeds=tracked.speeds[kept], values=values,
                              half_widths=widths, half_range=half, notes=(*tracked.notes, *notes)))  # fmt: skip
    return tuple(common)


def averaged_orders(
    tracked: Tracked, mean: MeanRotation, orders: FloatArray, method: CycleAverage, zero: PhaseReference
) -> list[TrackedOrders]:
    """Orders of signals averaged over blocks of whole cycles, complex peak amplitudes in SI."""
    shared = within(mean, tracked.begin, tracked.end)
    begins = method.blocks(shared)
    wanted = whole_multiples(orders, mean.cycle)
    blocks = list(
        averaged_blocks(
            tracked.read, shared, wanted, begins, tracked.per_cycle, tracked.transmitted, zero.angle, tracked.lost
        )
    )
    scattered, counts = half_widths(blocks), np.array([block.count for block in blocks]).T
    values = np.moveaxis(np.array([block.values for block in blocks]), 0, -1)
    bounds = shared.ends[begins]
    times = (bounds[1:] + bounds[:-1]) / 2
    speeds = np.diff(shared.angles[begins]) / np.diff(bounds)
    # Errors of pulses count as far as the scatter of single cycles, sqrt(n) times this, does not show them.
    widths = np.hypot(scattered, tracked.uncertain(wanted, speeds, np.sqrt(counts)[:, None] * scattered))
    size = "blocks of whole cycles" if method.step else f"blocks of {method.cycles} cycles"
    said = f"synchronous average over {size} of {mean.cycle} turns, intervals from the scatter between cycles"
    ranges = np.array([block.half_range for block in blocks]).T
    # The weights of a block rise and fall over the turns of one cycle; blocks of a step of speed differ in length.
    turns = 0.0 if method.step else float(method.cycles * mean.cycle)
    kernel = TrackingKernel(revolutions=turns, taper=float(mean.cycle) if turns else 0.0)
    return [
        tracked_values(signal, wanted, times, speeds, values[place], widths[place], ranges[place], zero,
                       (*mean.notes, said, *tracked.notes, *tracked.remarks(signal.name)), kernel)
        for place, signal in enumerate(tracked.signals)
    ]  # fmt: skip


def within(mean: MeanRotation, begin: float, end: float) -> MeanRotation:
    """Mean rotation over its whole cycles between two times in s."""
    kept = np.flatnonzero((mean.ends >= begin - 1e-12) & (mean.ends <= end + 1e-12))
    if len(kept) < 3:
        raise UsageError(
            f"{mean.name} has {max(len(kept) - 1, 0)} whole cycles between {begin:.6g} and {end:.6g} s, and an average "
            "needs two or more: record longer, or take the rotation from the same record",
            kind="too-short",
        )
    return replace(mean, ends=mean.ends[kept], angles=mean.angles[kept])


def _check_orders(orders: FloatArray, wheels: Sequence[WheelRotation]) -> None:
    if not len(orders) or orders[0] <= 0 or not np.isfinite(orders).all():
        raise UsageError(
            "orders are positive numbers of vibrations per revolution; give one or more", kind="out-of-range"
        )
    for wheel in wheels:
        wheel.check_orders(orders.tolist())


def _check_sampling(tracked: Tracked, mean: MeanRotation, order: float) -> None:
    """Refuse an order that is above half the sampling rate of a record at the highest speed, where it aliases."""
    speed = float(mean.speed(mean.ends[(mean.ends >= tracked.begin) & (mean.ends <= tracked.end)]).max(initial=0))
    rate = tracked.rate(speed)
    # An order o at speed Omega vibrates with o Omega/(2 pi) Hz, half the sampling rate at most.
    if order * speed > np.pi * rate * (1 + 1e-6):
        raise UsageError(
            f"order {order:g} is above half the sampling rate of {rate:g} Hz at {speed * RPM:.6g} r/min, where orders "
            f"up to {np.pi * rate / speed:.4g} can be told; leave it out, or record at a higher rate",
            kind="beyond-sampling",
        )


# Complex orders of a rotating test: of its signals, wheels and twists, with phases from one mark.


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
    >>> (orders,) = orders_of_test(record, {}, mean_rotation(record, "a"), orders=[3], channels=["T"])
    >>> print(abs(orders.along(3)).max().round(3))
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
        orders=orders, method=method, phase_reference=reference, further=further,
    )  # fmt: skip
