"""Times and errors of a rotating test: pulses to angle, tracked orders, calibration of a wheel; beside other programs.

python -m benchmarks.rotating_tests

All rows use one thread, and times are CPU seconds. The shaft, its pulses and its signals follow from closed forms here.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: one thread is meant

import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks._sizes import sized
from torsionnet import signals

TEETH = 60
PULSES = sized(1_000_000, 20_000)
RPM = np.pi / 30
RATE, SECONDS = 10e3, sized(60, 6)
ORDERS, FEW_ORDERS = np.arange(1, 25) / 2, np.array([1.5, 3, 6, 12])
FEW_SECONDS = sized(10, 6)
"""Length of the record for the filter with a coefficient for each sample and order, whose equations would not fit into
the memory with all orders of a minute."""
EDGE = 1.5
"""Time in s at either end of a record that no error counts, as filters and averages have less to go by there."""
TURNS = sized(100, 30)
PICKUP_ANGLE = np.radians(114)


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def row(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |")


def passages(places: Any, orders: Any, values: Any) -> Any:
    """Mean angle of rotation, in rad, at which a shaft with these complex orders of vibration reaches places in rad."""
    phi = np.array(places)
    for _ in range(8):  # Newton's method; the vibration is small against the distance of the teeth
        turning = [value * np.exp(1j * order * phi) for order, value in zip(orders, values, strict=True)]
        slope = 1 + sum((1j * order * one).real for order, one in zip(orders, turning, strict=True))
        phi -= (phi + sum(one.real for one in turning) - places) / slope
    return phi


def angles_between_pulses() -> None:
    """An order 20 of 0.002 degrees at 1500 r/min, read at as many times as there are pulses."""
    amplitude = np.radians(0.002)
    speed = 1500 * RPM
    times = passages(2 * np.pi * np.arange(PULSES) / TEETH, [20], [amplitude]) / speed
    at = np.linspace(times[600], times[-600], PULSES)
    channel, wheel = signals.PulseChannel("n1", times), signals.Wheel(teeth=TEETH)

    def band_limited() -> Any:
        return signals.wheel_rotation(channel, wheel).angle(at)

    def straight() -> Any:
        return np.interp(at, times, np.arange(len(times)) * 2 * np.pi / TEETH)

    print(
        f"\n{PULSES} pulses of {TEETH} teeth, read at as many times\n\n| | CPU s | error of order 20 |\n|---|---|---|"
    )
    for name, work in (("`wheel_rotation`, band-limited", band_limited), ("`numpy.interp`, straight lines", straight)):
        took, angle = timed(work)
        phi = speed * at
        beyond = angle - phi
        read = 2 * np.mean((beyond - beyond.mean()) * np.exp(-20j * phi))
        row(name, f"{took:.2f}", f"{100 * (abs(read) / amplitude - 1):.4f} %")


def run_up(seconds: float, orders: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Time in s, angle in rad, speed in r/min, orders over time, and their sum under noise, from 600 to 1800 r/min."""
    at = np.arange(round(seconds * RATE)) / RATE
    rate = 1200 * RPM / seconds
    phi, rpm = 600 * RPM * at + rate * at**2 / 2, 600 + 1200 * at / seconds
    slow = 1 + 0.3 * np.sin(2 * np.pi * at / 20 + orders[:, None])
    values = 100 / orders[:, None] * slow * np.exp(1j * orders[:, None])
    torque = sum((one * np.exp(1j * order * phi)).real for order, one in zip(orders, values, strict=True))
    return at, phi, rpm, values, torque + np.random.default_rng(1).normal(scale=20, size=len(at))


def demodulated(torque: Any, phi: Any, orders: Any) -> Any:
    """Each order by itself, turned to 0 Hz and through a low-pass that runs both ways: half is left at 1 Hz."""
    low = butter(2, 1.0, fs=RATE, output="sos")
    return np.array([2 * sosfiltfilt(low, torque * np.exp(-1j * order * phi)) for order in orders])


def tracked_orders(seconds: float, orders: Any, *, joint: bool) -> None:
    """Orders of a torque; ``joint`` filters of rota-order take all orders at once, as those of torsionnet always do."""
    at, phi, rpm, values, torque = run_up(seconds, orders)
    record = signals.Recording(
        (signals.Signal("angle", "angle", phi), signals.Signal("T", "torque", torque)), sampling_rate=RATE
    )
    zero = signals.PhaseReference(0.0, "begin of the record")

    def ours(method: Any) -> Any:
        rotation = signals.mean_rotation(record, "angle")
        (found,) = signals.track_orders(record, rotation, ["T"], orders=orders, method=method, phase_reference=zero)
        return found.times, found.values

    work: dict[str, Callable[[], Any]] = {
        "averages over 4 cycles": lambda: ours(signals.CycleAverage(cycles=4)),
        "Vold-Kalman filter, 2 Hz, all orders at once": lambda: ours(signals.VoldKalman(bandwidth=2.0)),
        "scipy, low-pass of 2 Hz, order by order": lambda: (at, demodulated(torque, phi, orders)),
    }
    try:
        from rota.extract import order_waveform, tracked_harmonics  # type: ignore[import-untyped]
    except ImportError:
        print("rota-order is not installed: pip install rota-order")
    else:
        filters = f"rota-order, Vold-Kalman filter, 2 Hz, {'all orders at once' if joint else 'order by order'}"
        work["rota-order, averages over 8 turns"] = lambda: (
            at, tracked_harmonics(torque, RATE, rpm, orders, window_revs=8.0).envelopes.T,
        )  # fmt: skip
        work[filters] = lambda: (  # their bandwidth is to one side of the order
            at, order_waveform(torque, RATE, rpm, orders, bandwidth=1.0, joint=joint).envelopes.T,
        )  # fmt: skip
    print(f"\n{len(orders)} orders of {seconds} s at {RATE / 1e3:g} kHz, 600 to 1800 r/min")
    print("\n| | CPU s | RMS error | largest error |\n|---|---|---|---|")
    for name, one in work.items():
        took, (times, found) = timed(one)
        inside = (times > EDGE) & (times < seconds - EDGE)
        true = np.array([np.interp(times, at, line.real) + 1j * np.interp(times, at, line.imag) for line in values])
        error = np.abs(found - true)[:, inside]
        row(name, f"{took:.2f}", f"{np.sqrt(np.mean(error**2)):.2f} N m", f"{error.max():.2f} N m")


def calibration() -> None:
    """Pitch errors of 0.05 degrees of a wheel with two pickups, found at 600, 1000 and 1800 r/min."""
    random = np.random.default_rng(2)
    positions = np.radians(0.05) * random.standard_normal(TEETH)
    positions -= positions.mean()
    values = np.radians(0.3) / ORDERS**1.5 * np.exp(1j * ORDERS)
    numbers = np.arange(TURNS * TEETH)
    tests = []
    for rpm in (600, 1000, 1800):
        pickups = []
        for name, angle in (("A", 0.0), ("B", PICKUP_ANGLE)):
            places = 2 * np.pi * numbers / TEETH + positions[numbers % TEETH] + angle
            times = passages(places, ORDERS, values) / (rpm * RPM) + 1e-7 * random.standard_normal(len(numbers))
            pickups.append(signals.PulseChannel(name, times))
        tests.append(signals.WheelTest(pickups[0], pickups[1]))
    took, found = timed(lambda: signals.calibrate_wheel(tests, signals.Wheel(teeth=TEETH), pickup_angle=PICKUP_ANGLE))

    def largest_order(errors: Any) -> float:
        return float(np.degrees(np.abs(2 / TEETH * np.fft.fft(errors))[1:13]).max())

    print(f"\nwheel of {TEETH} teeth, two pickups, three speeds of {TURNS} turns")
    print("\n| | CPU s | largest of orders 1 to 12 before | after |\n|---|---|---|---|")
    left = found.pattern.positions - positions
    row("`calibrate_wheel`", f"{took:.2f}", *(f"{largest_order(one):.5f} degrees" for one in (positions, left)))


def main() -> None:
    angles_between_pulses()
    tracked_orders(SECONDS, ORDERS, joint=False)
    tracked_orders(FEW_SECONDS, FEW_ORDERS, joint=True)
    calibration()


if __name__ == "__main__":
    main()
