"""Checks that a bench that turns fits its model: speeds, excitations, wheels that turn, recording systems."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import Fault, UsageError, did_you_mean
from torsionnet.base.units import RPM
from torsionnet.bench.plan.bench_motions import BenchMotion, CoastDown, GivenSpeed, RunUp, SteadyPoints
from torsionnet.bench.plan.plan import Plan
from torsionnet.bench.plan.toothed_wheel import ToothedWheel
from torsionnet.model.channels import named_sensor
from torsionnet.model.definition import all_nodes
from torsionnet.model.elements import GROUND
from torsionnet.model.speeds import total_ratio

if TYPE_CHECKING:
    from torsionnet.model.definition import Definition

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
        yield Fault("a bench that turns vibrates by excitations: of its model, which has none", on_key=True)
    for place, name in enumerate(motion.without):
        if name not in excitations:
            known = ", ".join(excitations) or "none"
            text = f'no excitation is named "{name}"{did_you_mean(name, excitations)}; there is {known}'
            yield Fault(text, ("without", place))
    nodes = all_nodes(definition.active)
    if motion.speed_of and motion.speed_of not in nodes:
        text = f'no node is named "{motion.speed_of}"{did_you_mean(motion.speed_of, nodes)}'
        yield Fault(text, ("speed_of",))
    given = definition.speeds
    if given is None and not motion.speed_of:
        yield Fault("the model has no speeds:; say with speed_of: which node turns so", on_key=True)
    if given is not None and motion.speed_of in ("", given.of) and not motion.outside_speeds:
        low, high = min(given.values), max(given.values)
        slowest, fastest = motion.extremes
        if slowest < low * (1 - SPEED_ROUNDING) or fastest > high * (1 + SPEED_ROUNDING):
            text = f"{slowest * RPM:.5g} to {fastest * RPM:.5g} rpm leaves the speeds of the model, {low * RPM:.5g} to"
            yield Fault(f"{text} {high * RPM:.5g} rpm; where that is meant, say outside_speeds: true", on_key=True)
    if isinstance(motion, CoastDown) and motion.time_constant is None and definition.load is None:
        yield Fault("the model has no load: that brakes; give a time_constant", on_key=True)


def _wheel_faults(
    name: str, part: ToothedWheel, plan: Plan, definition: Definition, values: Mapping[str, Any] | None
) -> Iterator[Fault]:
    if part.index and f"{name}_index" in plan.channels:
        yield Fault(f'"{name}_index" is a channel already; its index needs that name', ("index",))
    if part.wheel:
        first = plan.channels.get(part.wheel)
        if not isinstance(first, ToothedWheel) or first.wheel:
            wheels = [other for other, one in plan.channels.items() if isinstance(one, ToothedWheel) and not one.wheel]
            text = f'no channel with a wheel of its own is named "{part.wheel}"{did_you_mean(part.wheel, wheels)}'
            yield Fault(f"{text}; there is {', '.join(wheels) or 'none'}", ("wheel",))
        return
    sensor = named_sensor(part.sensor or name, definition.sensors)
    place = ("sensor",) if part.sensor else ()
    if sensor is not None and GROUND in sensor.nodes:
        yield Fault("a wheel on the ground does not turn; name a node that does", place, on_key=not place)
    elif sensor is not None and sensor.quantity == "angle" and plan.motion is not None:
        yield from (fault.under(*place) for fault in _still(sensor.row, plan.motion, definition, values))
        length, teeth = motion_length(plan.motion), part.teeth or 0
        pulses = teeth * plan.motion.extremes[1] * (length or 0.0)
        if pulses > MOST_PULSES * 6.3:  # about 2 pi: rad, not turns
            yield Fault(f"{pulses / 6.3:.3g} pulses are more than {MOST_PULSES:.0e}; shorten the test", ("teeth",))


def _still(
    row: Mapping[str, int], motion: BenchMotion, definition: Definition, values: Mapping[str, Any] | None
) -> Iterator[Fault]:
    """Fault of a wheel that stands still on average, or whose speed does not follow from that of the reference."""
    reference = motion.speed_of or (definition.speeds.of if definition.speeds else "")
    if values is None or not reference:
        return
    try:
        turning = sum(float(total_ratio(definition, values, node, reference)) * weight for node, weight in row.items())
    except UsageError as error:
        yield Fault(str(error), on_key=True)
        return
    if not turning:
        yield Fault(f"a wheel on {' against '.join(row)} does not turn; it gives no pulses", on_key=True)


def _system_faults(plan: Plan) -> Iterator[Fault]:
    counts = Counter(name for system in plan.systems.values() for name in system.channels)
    for called, system in plan.systems.items():
        for place, name in enumerate(system.channels):
            path = ("systems", called, "channels", place)
            if name not in plan.channels:
                known = ", ".join(plan.channels)
                yield Fault(f'no channel is named "{name}"{did_you_mean(name, plan.channels)}; there is {known}', path)
            elif counts[name] > 1:
                yield Fault(f"{name} is recorded by two systems", path)
        length = motion_length(plan.motion) if plan.motion is not None else None
        if length is not None and system.offset >= length:
            yield Fault(f"the system begins after the test, which ends at {length:g} s", ("systems", called, "offset"))
