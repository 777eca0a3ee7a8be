"""Checks that a bench test fits its model: names of inputs and sensors, units of ranges and noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.scalars import check_unit
from torsionnet.base.entries.spec import EntryError, not_none
from torsionnet.base.errors import MISSING_KEY, EntryPath, Fault, did_you_mean
from torsionnet.base.expressions import Number
from torsionnet.bench.plan.parts import Encoder, Transducer
from torsionnet.bench.plan.plan import Plan, Sensing
from torsionnet.bench.plan.strain_gauge import StrainGauge
from torsionnet.bench.plan.toothed_wheel import ToothedWheel
from torsionnet.bench.plan.turning_checks import motion_length, turning_faults
from torsionnet.model.channels import Sensor, named_sensor

if TYPE_CHECKING:
    from torsionnet.model.definition import Definition

MOST_SAMPLES = 1e8
"""Largest number of samples of a recorded channel, as more would take gigabytes of memory in the simulation."""
FEWEST_SAMPLES = 10
"""Smallest number of samples of a recorded channel, as fewer give no frequency response."""
DIMENSION_OF = {"angle": "angle", "twist": "angle", "velocity": "speed", "stress": "pressure"}
"""Dimension of a sensor's reading by its quantity, where the two have different names."""


def unfit_bench(definition: Definition) -> list[Fault]:
    """Faults of the bench test of a model that names what the model does not have, or gives it wrong units."""
    return [] if definition.bench is None else check_plan(definition.bench, definition)


def check_plan(
    plan: Plan, definition: Definition, path: EntryPath = ("bench",), values: Mapping[str, Any] | None = None
) -> list[Fault]:
    """Faults of a bench plan for this model; sensors written out in full are left to the solver.

    With the ``values`` of its parameters ratios are checked, too.
    """
    if plan.motion is None:
        faults = [*_drive(plan, definition), *_size(plan, not_none(plan.excitation).length)]
    else:
        faults = [*turning_faults(plan, definition, values), *_size(plan, motion_length(plan.motion))]
    for name, part in plan.channels.items():
        faults += [fault.under("channels", name) for fault in _channel(name, part, plan, definition)]
    return [fault.under(*path) for fault in faults]


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
            yield Fault(f"say with drive: on which input the torque acts; torque inputs: {declared}", on_key=True)
    elif plan.drive not in torques:
        reason = f'no torque input is named "{plan.drive}"{did_you_mean(plan.drive, torques)}'
        yield Fault(f"{reason}; torque inputs: {declared}", ("drive",))


def _size(plan: Plan, seconds: float | None) -> Iterator[Fault]:
    if seconds is None:
        return
    rate = plan.acquisition.rate
    if rate * seconds > MOST_SAMPLES:
        text = f"{seconds:g} s at {rate:g} Hz are {rate * seconds:.3g} samples; at most {MOST_SAMPLES:.0e}"
        yield Fault(text, ("acquisition", "rate"))
    elif rate * seconds < FEWEST_SAMPLES:
        text = f"{seconds:g} s at {rate:g} Hz are {rate * seconds:.3g} samples; at least {FEWEST_SAMPLES}"
        yield Fault(text, ("acquisition", "rate"))


def _channel(name: str, part: Sensing, plan: Plan, definition: Definition) -> Iterator[Fault]:
    if isinstance(part, ToothedWheel) and part.wheel:
        return  # it is checked with the wheel of its first pickup
    sensor = sensor_of(name, plan, definition)
    if sensor is None:
        known = ", ".join(definition.sensors) or "none"
        hint = did_you_mean(part.sensor or name, definition.sensors)
        text = f'no sensor is named "{part.sensor or name}"{hint}; sensors: {known}'
        yield Fault(
            f"{text}; or say sensor: velocity(node)", ("sensor",) if part.sensor else (), on_key=not part.sensor
        )
        return
    dimension = DIMENSION_OF.get(sensor.quantity, sensor.quantity)
    if isinstance(part, Encoder | ToothedWheel):
        if dimension != "angle":
            what = "an encoder" if isinstance(part, Encoder) else part.article
            yield Fault(f"{what} measures an angle; {sensor} needs a transducer instead", on_key=True)
        return
    if plan.acquisition.bits is not None and part.range is None:
        text = f"an analog input of {plan.acquisition.bits} bits divides a range; give the transducer one"
        yield Fault(text, on_key=True, kind=MISSING_KEY, about="range")
    for place, value in _in_unit_of_use(part).items():
        try:
            if value is not None:
                check_unit(value, dimension)
        except EntryError as error:
            yield error.fault.under(*place)


def _in_unit_of_use(part: Transducer) -> dict[EntryPath, Number | None]:
    """Values of a transducer in the unit of what it measures, by their paths in its entries."""
    found: dict[EntryPath, Number | None] = {(key,): getattr(part, key) for key in ("range", "noise", "offset")}
    if part.hum is not None:
        found["hum", "amplitude"] = part.hum.amplitude
    if isinstance(part, StrainGauge) and part.shunt is not None:
        found["shunt", "value"] = part.shunt.value
    if isinstance(part, StrainGauge) and part.zero_drift is not None:
        found["zero_drift", "change"] = part.zero_drift.change
    return found
