"""Transient peak, a quantity of a study, the peak over time under a step, a ramp or a pulse of torque."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Composite, Listed
from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Json, OneOf, Schema, Text, entry, not_none
from torsionnet.base.errors import Fault, TorsionnetError, UsageError, fault_of, got, remedy
from torsionnet.base.nearby_files import nearby_file
from torsionnet.drivetrain import Drivetrain
from torsionnet.identification.plan.fit_entries import READING, FileReading
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output, resolve_inputs
from torsionnet.linear.modes.natural_modes import natural_modes
from torsionnet.motion.scenario_courses import scenario_of
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import read_even
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, VariantBlock, register_quantity
from torsionnet.study.quantities.transfer_quantity import usage_faults

HISTORY_FORM = "{file: shock.csv, channel: T_M} or {rate: 1 kHz, values: [0, 10, ...]}"
"""Examples of the entry ``history`` of a transient peak in error messages, a channel of a file or a list of torques."""
_RATE = Value("samples per second", "frequency", exclusive=True)
_VALUES = Listed("torques", Value("a torque", "torque", lower=None), form="a list of torques")


@dataclass(frozen=True)
class TorqueHistory:
    """Torque samples (n,) in N m at a sampling rate in Hz."""

    rate: float
    values: tuple[float, ...]


class TorqueHistoryEntry(Composite[TorqueHistory]):
    """Entry for a torque over time, a channel of a recording, or a list of torques with their sampling rate."""

    @property
    def example(self) -> str:
        return HISTORY_FORM

    def read(self, raw: object) -> tuple[TorqueHistory | None, list[Fault]]:
        if isinstance(raw, TorqueHistory):
            return raw, []
        if isinstance(raw, Mapping) and set(raw) == {"rate", "values"}:
            return self._listed(raw)
        if not isinstance(raw, Mapping) or set(raw) - {"reading"} != {"file", "channel"}:
            return None, [Fault(f"expected {HISTORY_FORM}, {got(raw)}", kind="wrong-form")]
        reading, wrong = READING.read(raw["reading"]) if "reading" in raw else (None, [])
        if wrong:
            return None, [fault.under("reading") for fault in wrong]
        try:
            return _recorded(str(raw["file"]), str(raw["channel"]), reading), []
        except EntryError as error:
            return None, [fault.under("file") for fault in error.faults]
        except TorsionnetError as error:
            return None, [replace(fault_of(error, error.kind), path=("channel",))]

    def _listed(self, raw: Mapping[str, Any]) -> tuple[TorqueHistory | None, list[Fault]]:
        (rate, wrong), (values, others) = _RATE.read(raw["rate"]), _VALUES.read(raw["values"])
        faults = [fault.under("rate") for fault in wrong] + [fault.under("values") for fault in others]
        if not faults and len(values) < 2:
            faults = [Fault("a torque over time has two samples or more", ("values",), kind="too-short")]
        return (None if faults else TorqueHistory(not_none(rate), values)), faults

    def plain(self, value: Any) -> Json:
        """Sampling rate in Hz and torques in N m as JSON data, so that a study can be read without the recording."""
        return {"rate": value.rate, "values": list(value.values)}

    def schema(self) -> Schema:
        samples: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2}
        forms: tuple[Schema, ...] = (
            {"file": {"type": "string"}, "channel": {"type": "string"}, "reading": READING.schema()},
            {"rate": SCALAR_SCHEMA, "values": samples},
        )
        return {
            "description": self.description,
            "anyOf": [
                {"type": "object", "properties": form, "required": list(form)[:2], "additionalProperties": False}
                for form in forms
            ],
        }


def _recorded(file: str, channel: str, reading: FileReading | None) -> TorqueHistory:
    record = read_even(nearby_file(file), names=[channel], **(reading or FileReading()).arguments)
    signal = record[channel]
    if signal.quantity != "torque":
        raise EntryError(
            f'"{channel}" of {file} is no torque, but {signal.quantity or "of unknown quantity"}', kind="wrong-unit"
        )
    if record.times is not None:
        raise EntryError(
            f"{file} was not sampled at even steps; {remedy('resample=True')} makes them even", kind="uneven-samples"
        )
    if not np.isfinite(signal.values).all() or len(signal.values) < 2:
        raise EntryError(f'"{channel}" of {file} has gaps, or less than two samples', kind="missing-data")
    return TorqueHistory(record.sampling_rate, tuple(signal.values.tolist()))


SAMPLES_PER_PERIOD = 40
"""Samples in a period of the nominal model's highest vibration, between which peaks are at most 0.3 % higher."""
MOST_SAMPLES = 2_000_000
"""Most samples of one simulation of a transient, as more take much time and memory for each variant."""
STEP = "step"
SHAPES: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    STEP: np.ones_like,
    "ramp": lambda share: np.minimum(share, 1.0),
    "half_sine": lambda share: np.where(share < 1, np.sin(np.pi * share), 0.0),
}
"""Shapes of a torque by name, as functions from time over the rise time to the torque over its size."""
READ: Mapping[str, Callable[[FloatArray], float]] = {
    "size": lambda values: float(np.abs(values).max()),
    "highest": lambda values: float(values.max()),
    "lowest": lambda values: float(values.min()),
    "range": lambda values: float(values.max() - values.min()),
    "last": lambda values: float(values[-1]),
}

READ_WORDS = {
    "size": "largest size",
    "highest": "highest value",
    "lowest": "lowest value",
    "range": "range",
    "last": "last value",
}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class TransientPeak(StudyQuantity):
    """Peak in SI of a sensor after a torque sets in on a drivetrain at rest.

    Motion is exact from sample to sample; peaks are those of the samples: with 40 in a period of the highest vibration
    they are at most 0.3 % of that vibration lower than those between. Below, a step makes twice its torque.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("mass", node="a", inertia=2), tn.Spring("k", nodes=("a", "ground"), stiffness="k")]
    >>> rig = tn.Drivetrain("one mass", elements, parameters={"k": 8e4})
    >>> peak = TransientPeak(output="torque(k)", input="a", torque="10 N*m", duration="0.1 s", rate=1e4)
    >>> peak.evaluate(VariantBlock(rig, {"k": np.array([8e4, 1e5])}, {}, None)).round(2).tolist()
    [[20.0], [20.0]]
    """

    kind: ClassVar[str] = "transient_peak"
    singly: ClassVar[bool] = True

    output: str = entry(Text("sensor, node, torque(element), stress(shaft), ..."))
    input: str = entry(Text("input or node on which the torque acts"))
    torque: float | None = entry(Value("its size", "torque", lower=None), None)
    shape: str | None = entry(OneOf("how it comes; default: as a step", tuple(SHAPES)), None)
    rise: float | None = entry(Value("time until a ramp is up or a half sine is over", "time", exclusive=True), None)
    duration: float | None = entry(Value("time that is simulated", "time", exclusive=True), None)
    rate: float | None = entry(
        Value(
            f"samples a second; default: {SAMPLES_PER_PERIOD} in the shortest period of vibration",
            "frequency",
            exclusive=True,
        ),
        None,
    )
    history: TorqueHistory | None = entry(
        TorqueHistoryEntry("instead of torque, shape and duration: a torque over time"), None
    )
    value: str = entry(OneOf("what of the motion", tuple(READ)), "size")

    def contradictions(self) -> list[Fault]:
        if (self.torque is None) == (self.history is None):
            kind = "missing-entry" if self.history is None else "contradicting-entries"
            return [Fault("what comes is either a torque with its duration, or a history", on_key=True, kind=kind)]
        if self.history is not None:
            given = [name for name in ("shape", "rise", "duration", "rate") if getattr(self, name) is not None]
            return [
                Fault(f"the history determines {name}; leave it out", (name,), on_key=True, kind="needless-entry")
                for name in given
            ]
        faults = []
        if self.duration is None:
            faults.append(
                Fault(
                    "a torque needs the duration that is simulated, as duration: 2 s", on_key=True, kind="missing-entry"
                )
            )
        if self.torque == 0:
            faults.append(
                Fault("a torque of 0 moves nothing; give its size, as 500 N*m", ("torque",), kind="out-of-range")
            )
        if self.shape in (None, STEP) and self.rise is not None:
            faults.append(
                Fault(
                    "a step has no rise; leave it out, or choose another shape",
                    ("rise",),
                    on_key=True,
                    kind="needless-entry",
                )
            )
        if self.shape not in (None, STEP) and self.rise is None:
            faults.append(
                Fault(f"a {str(self.shape).replace('_', ' ')} needs its rise", on_key=True, kind="missing-entry")
            )
        return faults

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        faults = [
            *usage_faults(lambda: named_output(model, self.output), "output"),
            *usage_faults(lambda: resolve_inputs(model, self.input, None), "input"),
        ]
        yield from faults or usage_faults(lambda: self._motion(model, self.torques(model)))

    @property
    def words(self) -> str:
        what = READ_WORDS[self.value]
        if self.history is not None:
            return f"{what} of {self.output} after a history of torques on {self.input}"
        shape = (self.shape or STEP).replace("_", " ")
        rise = "" if self.rise is None else f" of {self.rise:g} s"
        torque = f"a {shape}{rise} of {self.torque:g} N*m on {self.input}"
        return f"{what} of {self.output} within {self.duration:g} s of {torque}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(named_output(model, self.output).unit)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        history = self.torques(block.model)
        return block.one_by_one(lambda model: READ[self.value](self._motion(model, history)))

    def torques(self, model: Drivetrain) -> TorqueHistory:
        """Torque samples in N m, at a sampling rate in Hz that suits the nominal model."""
        if self.history is not None:
            return self.history
        assert self.torque is not None
        assert self.duration is not None
        rate = self._rate(model, self.duration)
        times = np.arange(int(np.ceil(self.duration * rate)) + 1) / rate
        values = self.torque * SHAPES[self.shape or STEP](times / (self.rise or 1.0))
        return TorqueHistory(rate, tuple(values.tolist()))

    def _motion(self, model: Drivetrain, history: TorqueHistory) -> FloatArray:
        return np.asarray(model.simulate(self.output, {self.input: history.values}, history.rate).signals[-1].values)

    def _rate(self, model: Drivetrain, duration: float) -> float:
        highest = float(np.max(natural_modes(model)[0].damped_frequencies, initial=0.0))
        # Fine enough for the highest mode, the whole duration and the rise.
        rate = self.rate or max(
            SAMPLES_PER_PERIOD * highest, 1000 / duration, SAMPLES_PER_PERIOD / (self.rise or np.inf)
        )
        if rate * duration > MOST_SAMPLES:
            text = f"{duration:g} s at {rate:g} Hz are more than {MOST_SAMPLES} samples"
            raise UsageError(f"{text}; give a lower rate or a shorter duration", kind="too-large")
        return rate


# Scenario peak, a quantity of a study, the peak of a sensor over time in a scenario of the model.


@register_quantity
@dataclass(frozen=True, kw_only=True)
class ScenarioPeak(StudyQuantity):
    """Peak in SI of a sensor in a scenario of the model, simulated for every variant.

    Peaks are those of the samples, see the entry ``rate`` of the scenario.

    Examples
    --------
    >>> import numpy as np
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("mass", node="a", inertia=2), tn.Spring("k", nodes=("a", "ground"), stiffness="k")]
    >>> step = {"type": "torques", "duration": "0.1 s", "rate": 1e4, "torque": {"a": "10 N*m"}}
    >>> rig = tn.Drivetrain("one mass", elements, parameters={"k": 8e4}, scenarios={"step": step})
    >>> peak = ScenarioPeak(scenario="step", output="torque(k)")
    >>> peak.evaluate(VariantBlock(rig, {"k": np.array([8e4, 1e5])}, {}, None)).round(2).tolist()
    [[20.0], [20.0]]
    """

    kind: ClassVar[str] = "scenario_peak"
    singly: ClassVar[bool] = True

    scenario: str = entry(Text("name of the scenario in the model"))
    output: str = entry(Text("sensor, node, torque(element), stress(shaft), ..."))
    value: str = entry(OneOf("what of the motion", tuple(READ)), "size")
    rate: float | None = entry(
        Value("samples a second, instead of what the scenario says", "frequency", exclusive=True), None
    )

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        faults = [
            *usage_faults(lambda: named_output(model, self.output), "output"),
            *usage_faults(lambda: scenario_of(model, self.scenario), "scenario"),
        ]
        yield from faults or usage_faults(lambda: self._motion(model))

    @property
    def words(self) -> str:
        return f"{READ_WORDS[self.value]} of {self.output} in the scenario {self.scenario}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(named_output(model, self.output).unit)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return block.one_by_one(lambda model: READ[self.value](self._motion(model).signals[-1].values))

    def _motion(self, model: Drivetrain) -> Recording:
        return model.simulate(self.output, sampling_rate=self.rate, scenario=self.scenario)
