"""Checks that a bench test fits its model: names of inputs and sensors, units of ranges and noise."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.scalars import check_unit
from torsionnet.base.entries.spec import EntryError, not_none
from torsionnet.base.errors import EntryPath, Fault, UsageError, did_you_mean
from torsionnet.base.expressions import Number
from torsionnet.base.units import RPM
from torsionnet.bench.plan.parts import Encoder, StrainGauge, ToothedWheel, Transducer
from torsionnet.bench.plan.plan import BenchMotion, CoastDown, GivenSpeed, Plan, RunUp, Sensing, SteadyPoints
from torsionnet.model.channels import Sensor, named_sensor
from torsionnet.model.definition import all_nodes
from torsionnet.model.elements import GROUND
from torsionnet.model.speeds import total_ratio

if TYPE_CHECKING:
    from torsionnet.model.definition import Definition


# Checks that a bench that turns fits its model: speeds, excitations, wheels that turn, recording systems.

SPEED_ROUNDING = 1e-9
"""Relative distance from the ends of the speeds of a model within which a speed counts as inside."""
MOST_PULSES = 2e7
"""Largest number of pulses of a channel: an hour of 60 teeth at 5000 rpm."""


def turning_faults(plan: Plan, definition: Definition, values: Mapping[str, Any] | None) -> Iterator[Fault]:
    """Faults of the motion, the wheels and the systems of a plan; ratios only with the values of the parameters."""
    motion = plan.motion
    assert motion is not None
    yield from (fault.under("motion") for fault in _motion_faults(motion, definition))
    for name, part in plan.channels.items():
        if isinstance(part, ToothedWheel):
            yield from (fault.under("channels", name) for fault in _wheel_faults(name, part, plan, definition, values))
    yield from _system_faults(plan)


def motion_length(motion: BenchMotion) -> float | None:
    """Longest time of a motion in s, None where it follows from the drag of the model."""
    if isinstance(motion, SteadyPoints):
        return motion.duration
    if isinstance(motion, RunUp):
        return motion.length
    if isinstance(motion, GivenSpeed):
        return motion.points[0][-1]
    if isinstance(motion, CoastDown) and motion.time_constant is not None:
        return motion.fall()[0][-1]
    return None


def _motion_faults(motion: BenchMotion, definition: Definition) -> Iterator[Fault]:
    excitations = definition.excitations
    if not excitations:
        yield Fault(
            "a bench that turns vibrates by excitations: of its model, which has none",
            on_key=True,
            kind="missing-entry",
        )
    for place, name in enumerate(motion.without):
        if name not in excitations:
            known = ", ".join(excitations) or "none"
            text = f'no excitation is named "{name}"{did_you_mean(name, excitations)}; there is {known}'
            yield Fault(text, ("without", place), kind="unknown-name")
    nodes = all_nodes(definition.active)
    if motion.speed_of and motion.speed_of not in nodes:
        text = f'no node is named "{motion.speed_of}"{did_you_mean(motion.speed_of, nodes)}'
        yield Fault(text, ("speed_of",), kind="unknown-node")
    given = definition.speeds
    if given is None and not motion.speed_of:
        yield Fault(
            "the model has no speeds:; say with speed_of: which node turns so", on_key=True, kind="missing-entry"
        )
    if given is not None and motion.speed_of in ("", given.of) and not motion.outside_speeds:
        low, high = min(given.values), max(given.values)
        slowest, fastest = motion.extremes
        if slowest < low * (1 - SPEED_ROUNDING) or fastest > high * (1 + SPEED_ROUNDING):
            text = f"{slowest * RPM:.5g} to {fastest * RPM:.5g} rpm leaves the speeds of the model, {low * RPM:.5g} to"
            yield Fault(
                f"{text} {high * RPM:.5g} rpm; where that is meant, say outside_speeds: true",
                on_key=True,
                kind="out-of-range",
            )
    if isinstance(motion, CoastDown) and motion.time_constant is None and definition.load is None:
        yield Fault("the model has no load: that brakes; give a time_constant", on_key=True, kind="missing-entry")


def _wheel_faults(
    name: str, part: ToothedWheel, plan: Plan, definition: Definition, values: Mapping[str, Any] | None
) -> Iterator[Fault]:
    if part.index and f"{name}_index" in plan.channels:
        yield Fault(f'"{name}_index" is a channel already; its index needs that name', ("index",), kind="repeated-name")
    if part.wheel:
        first = plan.channels.get(part.wheel)
        if not isinstance(first, ToothedWheel) or first.wheel:
            wheels = [
                other
                for other, channel in plan.channels.items()
                if isinstance(channel, ToothedWheel) and not channel.wheel
            ]
            text = f'no channel with a wheel of its own is named "{part.wheel}"{did_you_mean(part.wheel, wheels)}'
            yield Fault(f"{text}; there is {', '.join(wheels) or 'none'}", ("wheel",), kind="unknown-channel")
        return
    sensor = named_sensor(part.sensor or name, definition.sensors)
    place = ("sensor",) if part.sensor else ()
    if sensor is not None and GROUND in sensor.nodes:
        yield Fault(
            "a wheel on the ground does not turn; name a node that does", place, on_key=not place, kind="grounded-node"
        )
    elif sensor is not None and sensor.quantity == "angle" and plan.motion is not None:
        try:
            ratio = _mean_ratio(sensor.row, plan.motion, definition, values)
        except UsageError as error:
            yield Fault(str(error), on_key=True, kind=error.kind).under(*place)
            return
        if not ratio:
            text = f"a wheel on {' against '.join(sensor.row)} does not turn; it gives no pulses"
            yield Fault(text, on_key=True, kind="zero-reading").under(*place)
        # At most: at the highest speed during the whole test, as often as teeth pass in a turn of the wheel.
        speed = abs(ratio) * part.gearing * plan.motion.extremes[1]
        teeth = (part.teeth or 0) - part.missing_teeth
        pulses = teeth * speed / (2 * math.pi) * (motion_length(plan.motion) or 0.0)
        if pulses > MOST_PULSES:
            yield Fault(
                f"{pulses:.3g} pulses are more than {MOST_PULSES:.0e}; shorten the test", ("teeth",), kind="too-large"
            )


def _mean_ratio(
    row: Mapping[str, int], motion: BenchMotion, definition: Definition, values: Mapping[str, Any] | None
) -> float:
    """Mean speed of the node of a wheel, or of two against each other, over that of the reference; 1 without values."""
    reference = motion.speed_of or (definition.speeds.of if definition.speeds else "")
    if values is None or not reference:
        return 1.0
    return sum(float(total_ratio(definition, values, node, reference)) * weight for node, weight in row.items())


def _system_faults(plan: Plan) -> Iterator[Fault]:
    counts = Counter(name for system in plan.systems.values() for name in system.channels)
    for called, system in plan.systems.items():
        for place, name in enumerate(system.channels):
            path = ("systems", called, "channels", place)
            if name not in plan.channels:
                known = ", ".join(plan.channels)
                yield Fault(
                    f'no channel is named "{name}"{did_you_mean(name, plan.channels)}; there is {known}',
                    path,
                    kind="unknown-channel",
                )
            elif counts[name] > 1:
                yield Fault(f"{name} is recorded by two systems", path, kind="repeated-name")
        length = motion_length(plan.motion) if plan.motion is not None else None
        if length is not None and system.offset >= length:
            yield Fault(
                f"the system begins after the test, which ends at {length:g} s",
                ("systems", called, "offset"),
                kind="out-of-range",
            )


MOST_SAMPLES = 1e8
"""Largest number of samples of a recorded channel, as more would take gigabytes of memory in the simulation."""
FEWEST_SAMPLES = 10
"""Smallest number of samples of a recorded channel, as fewer give no frequency response."""
DIMENSION_OF = {"angle": "angle", "twist": "angle", "velocity": "speed", "stress": "pressure"}
"""Dimension of a sensor's reading by its quantity, where the two have different names."""


def unfit_bench(definition: Definition) -> list[Fault]:
    """Faults of the bench test of a model that names what the model does not have, or gives it wrong units."""
    return [] if definition.bench is None else check_plan(definition.bench, definition)


def check_plan(plan: Plan, definition: Definition, values: Mapping[str, Any] | None = None) -> list[Fault]:
    """Faults of a bench plan for this model; sensors written out in full are left to the solver.

    With the ``values`` of its parameters ratios are checked, too.
    """
    if plan.motion is None:
        faults = [*_drive(plan, definition), *_size(plan, not_none(plan.excitation).length)]
    else:
        faults = [*turning_faults(plan, definition, values), *_size(plan, motion_length(plan.motion))]
    for name, part in plan.channels.items():
        faults += [fault.under("channels", name) for fault in _channel(name, part, plan, definition)]
    return [fault.under("bench") for fault in faults]


def sensor_of(name: str, plan: Plan, definition: Definition) -> Sensor | None:
    """Sensor of the model that a channel measures, None if it names none; that of its wheel for a further pickup."""
    part = plan.channels[name]
    if isinstance(part, ToothedWheel) and part.wheel:
        first = plan.channels.get(part.wheel)
        return named_sensor((first.sensor if first else None) or part.wheel, definition.sensors)
    return named_sensor(part.sensor or name, definition.sensors)


def _drive(plan: Plan, definition: Definition) -> Iterator[Fault]:
    torques = [name for name, channel in definition.inputs.items() if channel.quantity == "torque"]
    declared = ", ".join(torques) or "none"
    if not plan.drive:
        if len(torques) != 1:
            yield Fault(
                f"say with drive: on which input the torque acts; torque inputs: {declared}",
                on_key=True,
                kind="missing-entry",
            )
    elif plan.drive not in torques:
        reason = f'no torque input is named "{plan.drive}"{did_you_mean(plan.drive, torques)}'
        yield Fault(f"{reason}; torque inputs: {declared}", ("drive",), kind="unknown-channel")


def _size(plan: Plan, seconds: float | None) -> Iterator[Fault]:
    if seconds is None:
        return
    rate = plan.acquisition.rate
    if rate * seconds > MOST_SAMPLES:
        text = f"{seconds:g} s at {rate:g} Hz are {rate * seconds:.3g} samples; at most {MOST_SAMPLES:.0e}"
        yield Fault(text, ("acquisition", "rate"), kind="too-large")
    elif rate * seconds < FEWEST_SAMPLES:
        text = f"{seconds:g} s at {rate:g} Hz are {rate * seconds:.3g} samples; at least {FEWEST_SAMPLES}"
        yield Fault(text, ("acquisition", "rate"), kind="too-short")


def _channel(name: str, part: Sensing, plan: Plan, definition: Definition) -> Iterator[Fault]:
    if isinstance(part, ToothedWheel) and part.wheel:
        return  # it is checked with the wheel of its first pickup
    sensor = sensor_of(name, plan, definition)
    if sensor is None:
        known = ", ".join(definition.sensors) or "none"
        hint = did_you_mean(part.sensor or name, definition.sensors)
        text = f'no sensor is named "{part.sensor or name}"{hint}; sensors: {known}'
        yield Fault(
            f"{text}; or say sensor: velocity(node)",
            ("sensor",) if part.sensor else (),
            on_key=not part.sensor,
            kind="unknown-channel",
        )
        return
    dimension = DIMENSION_OF.get(sensor.quantity, sensor.quantity)
    if isinstance(part, Encoder | ToothedWheel):
        if dimension != "angle":
            what = "an encoder" if isinstance(part, Encoder) else part.article
            yield Fault(
                f"{what} measures an angle; {sensor} needs a transducer instead", on_key=True, kind="unfit-channel"
            )
        return
    if plan.acquisition.bits is not None and part.range is None:
        text = f"an analog input of {plan.acquisition.bits} bits divides a range; give the transducer one"
        yield Fault(text, on_key=True, kind="missing-entry", about="range")
    for place, value in _in_unit_of_use(part).items():
        try:
            if value is not None:
                check_unit(value, dimension)
        except EntryError as error:
            yield error.fault.under(*place)


def _in_unit_of_use(part: Transducer) -> dict[EntryPath, Number | None]:
    """Values of a transducer in the unit of what it measures, by their paths in its entries."""
    values: dict[EntryPath, Number | None] = {(key,): getattr(part, key) for key in ("range", "noise", "offset")}
    if part.hum is not None:
        values["hum", "amplitude"] = part.hum.amplitude
    if isinstance(part, StrainGauge) and part.shunt is not None:
        values["shunt", "value"] = part.shunt.value
    if isinstance(part, StrainGauge) and part.zero_drift is not None:
        values["zero_drift", "change"] = part.zero_drift.change
    return values
