"""The whole description of a test on a bench, and how it is read from a model file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field
from typing import Any, TypeVar

from torsionnet.core.errors import Fault, ModelError, Path, UsageError, did_you_mean, unknown_key
from torsionnet.model.bench.excitations import EXCITATIONS, excitation_data, specs_of
from torsionnet.model.bench.fields import BenchPart
from torsionnet.model.bench.parts import SENSORS, Acquisition, Encoder, Exciter, Transducer
from torsionnet.model.elements.fields import Count, FieldError, Spec, spec_of
from torsionnet.signals.excitation.excitation import Excitation

PLAN_KEYS = ("drive", "excitation", "exciter", "channels", "acquisition", "seed")
T = TypeVar("T")
PartType = TypeVar("PartType", bound=BenchPart)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A test: what drives the drivetrain, what is measured, and how it is recorded.

    Attributes
    ----------
    excitation : Excitation
        Set-point of the torque.
    channels : mapping of str to Transducer or Encoder
        By the name of a sensor of the model, or of any other name with a ``sensor`` of its own.
    acquisition : Acquisition
    exciter : Exciter, optional
        By default delivers its set-point exactly.
    drive : str, optional
        Input of the model on which the torque acts; by default the only one there is.
    seed : int, optional
        Of noise and of the encoders' starting positions; the same seed gives the same record.
    """

    excitation: Excitation
    channels: Mapping[str, Transducer | Encoder]
    acquisition: Acquisition
    exciter: Exciter = field(default_factory=Exciter)
    drive: str = ""
    seed: int = 0

    def to_data(self) -> dict[str, Any]:
        """The ``bench:`` section of a model file that makes this plan."""
        channels = {name: {"type": part.kind, **part.to_data()} for name, part in self.channels.items()}
        exciter = self.exciter.to_data()
        return {
            **({"drive": self.drive} if self.drive else {}),
            "excitation": excitation_data(self.excitation),
            **({"exciter": exciter} if exciter else {}),
            "channels": channels,
            "acquisition": self.acquisition.to_data(),
            **({"seed": self.seed} if self.seed else {}),
        }


def read_plan(raw: Any, path: Path = ("bench",)) -> tuple[Plan | None, list[Fault]]:
    """Plan from the ``bench:`` section of a model file, None if anything in it is wrong, and all faults."""
    if isinstance(raw, Plan):
        return raw, []
    if not isinstance(raw, Mapping):
        text = f"expected the entries {', '.join(PLAN_KEYS)}, got {raw!r}"
        return None, [Fault(text, path)]
    rest = f"a bench has {', '.join(PLAN_KEYS)}"
    faults = [unknown_key(key, PLAN_KEYS, (key,), rest) for key in raw if key not in PLAN_KEYS]
    entries: dict[str, Any] = {}
    readers: dict[str, Callable[[Any], tuple[Any, list[Fault]]]] = {
        "drive": _drive,
        "excitation": _excitation,
        "exciter": lambda entry: _part(Exciter, entry),
        "channels": _channels,
        "acquisition": lambda entry: _part(Acquisition, entry),
        "seed": _seed,
    }
    for key, read in readers.items():
        if key in raw:
            entries[key], found = read(raw[key])
            faults += [fault.under(key) for fault in found]
        elif key in ("excitation", "channels", "acquisition"):
            faults.append(Fault(f"a bench needs {key}: {_HINTS[key]}", on_key=True, kind="missing key", about=key))
    faults = [fault.under(*path) for fault in faults]
    return (None if faults else Plan(**entries)), faults


_HINTS = {
    "excitation": "{type: linear chirp, start: 0.1 Hz, stop: 80 Hz, duration: 100 s, amplitude: 15 N*m}",
    "channels": "{name of a sensor: {type: encoder, lines: 1024}, ...}",
    "acquisition": "{rate: 10 kHz}",
}


def _drive(raw: Any) -> tuple[str, list[Fault]]:
    return (raw, []) if isinstance(raw, str) else ("", [Fault(f"expected the name of an input, got {raw!r}")])


def _seed(raw: Any) -> tuple[int, list[Fault]]:
    try:
        return Count("", lower=0, upper=2**32 - 1).coerce(raw), []
    except FieldError as error:
        return 0, [error.fault]


def _excitation(raw: Any) -> tuple[Excitation | None, list[Fault]]:
    cls, faults = _type(raw, EXCITATIONS, "excitation")
    if cls is None:
        return None, faults
    values, faults = _values(raw, specs_of(cls), cls.kind)
    if faults:
        return None, faults
    try:
        return cls(**values), []
    except UsageError as error:
        return None, [Fault(str(error), on_key=True)]


def _channels(raw: Any) -> tuple[dict[str, Transducer | Encoder], list[Fault]]:
    if not isinstance(raw, Mapping) or not raw:
        return {}, [Fault(f"expected {_HINTS['channels']}, got {raw!r}")]
    channels: dict[str, Transducer | Encoder] = {}
    faults: list[Fault] = []
    for name, entry in raw.items():
        cls, found = _type(entry, SENSORS, "sensor")
        if cls is not None:
            part, found = _part(cls, {key: value for key, value in entry.items() if key != "type"})
            if part is not None:
                channels[str(name)] = part
        faults += [fault.under(name) for fault in found]
    return channels, faults


def _type(raw: Any, known: Mapping[str, type[T]], what: str) -> tuple[type[T] | None, list[Fault]]:
    kind = raw.get("type") if isinstance(raw, Mapping) else None
    names = ", ".join(known)
    if not isinstance(raw, Mapping) or kind is None:
        return None, [Fault(f"expected {{type: ..., ...}} with one of the types {names}", on_key=True)]
    if not isinstance(kind, str) or kind not in known:
        hint = did_you_mean(str(kind), known)
        return None, [Fault(f'no {what} type is named "{kind}"{hint}; known: {names}', ("type",))]
    return known[kind], []


def _part(cls: type[PartType], raw: Any) -> tuple[PartType | None, list[Fault]]:
    if not isinstance(raw, Mapping):
        return None, [Fault(f"expected {{name: value, ...}}, got {raw!r}")]
    specs = {declared.name: (spec_of(declared), declared.default is MISSING) for declared in cls.declared()}
    values, faults = _values(raw, specs, cls.kind)
    if faults:
        return None, faults
    try:
        return cls(**values), []
    except ModelError as error:
        return None, list(error.faults)


def _values(
    raw: Mapping[Any, Any], specs: Mapping[str, tuple[Spec, bool]], kind: str
) -> tuple[dict[str, Any], list[Fault]]:
    rest = f"{kind} has {', '.join(specs)}"
    faults = [unknown_key(key, specs, (key,), rest) for key in raw if key != "type" and key not in specs]
    values = {}
    for name, (spec, required) in specs.items():
        if name in raw:
            try:
                values[name] = spec.coerce(raw[name])
            except FieldError as error:
                faults.append(error.fault.under(name))
        elif required:
            text = f"{kind} needs {name}: {spec.description}"
            faults.append(Fault(text, on_key=True, kind="missing key", about=name))
    return values, faults
