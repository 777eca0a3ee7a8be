"""What the torque of a bench may be, and how model files write it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any

from torsionnet.core.errors import UsageError
from torsionnet.model.bench.fields import Value
from torsionnet.model.elements.fields import SCALAR_SCHEMA, Count, FieldError, Spec, plain_number
from torsionnet.signals.excitation import BurstRandom, LinearChirp, LogarithmicSweep, Multisine, SteppedSine
from torsionnet.signals.excitation.excitation import Excitation
from torsionnet.signals.excitation.sweeps import steps_between


@dataclass(frozen=True, eq=False, repr=False)
class Frequencies(Spec):
    """A list of frequencies, or ``{from: 1 Hz, to: 40 Hz, count: 60}`` at equal factors."""

    def coerce(self, raw: Any) -> tuple[float, ...]:
        if isinstance(raw, Mapping):
            return self._between(raw)
        if isinstance(raw, str) or not hasattr(raw, "__iter__"):
            msg = f"expected a list of frequencies or {{from: 1 Hz, to: 40 Hz, count: 60}}, got {raw!r}"
            raise FieldError(msg)
        return tuple(_within(_FREQUENCY, value, index) for index, value in enumerate(raw))

    def _between(self, raw: Mapping[str, Any]) -> tuple[float, ...]:
        specs: dict[str, Spec] = {"from": _FREQUENCY, "to": _FREQUENCY, "count": Count("", lower=2, upper=100_000)}
        if raw.keys() != specs.keys():
            msg = f"expected from, to and count, got {', '.join(map(str, raw)) or 'nothing'}"
            raise FieldError(msg)
        start, stop, count = (_within(spec, raw[key], key) for key, spec in specs.items())
        try:
            return steps_between(start, stop, count)
        except UsageError as error:
            raise FieldError(str(error)) from None

    def plain(self, value: Any) -> Any:
        return [plain_number(frequency) for frequency in value]

    def schema(self) -> dict[str, Any]:
        listed = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 1}
        keys = {"from": SCALAR_SCHEMA, "to": SCALAR_SCHEMA, "count": {"type": "integer", "minimum": 2}}
        between = {"type": "object", "properties": keys, "required": list(keys), "additionalProperties": False}
        return {"anyOf": [listed, between], "description": self.description}


def _within(spec: Spec, raw: Any, key: str | int) -> Any:
    try:
        return spec.coerce(raw)
    except FieldError as error:
        raise FieldError(error.fault.under(key)) from None


_FREQUENCY = Value("frequency", "frequency")

EXCITATIONS: dict[str, type[Excitation]] = {
    cls.kind: cls for cls in (LinearChirp, LogarithmicSweep, SteppedSine, Multisine, BurstRandom)
}
SPECS: dict[str, Spec] = {
    "amplitude": Value("peak of the alternating torque", "torque"),
    "mean": Value("torque added throughout; the test begins in its equilibrium", "torque", lower=None),
    "start": Value("first frequency, or lower end of the band", "frequency"),
    "stop": Value("last frequency, or upper end of the band", "frequency"),
    "duration": Value("length of the sweep", "time"),
    "frequencies": Frequencies("frequencies, one after the other"),
    "hold": Value("time for each frequency, rounded up to whole periods", "time"),
    "period": Value("length of a period; lines are 1/period apart", "time"),
    "periods": Count("how many periods", upper=100_000),
    "seed": Count("the same seed gives the same signal", lower=0, upper=2**32 - 1),
    "share": Value("share of a period with noise", "1"),
}


def specs_of(cls: type[Excitation]) -> dict[str, tuple[Spec, bool]]:
    """Specification of every entry of an excitation, and whether it must be given; its own entries first.

    An amplitude must be given: that of 1 N m which signals have by themselves is nobody's test.
    """
    own = sorted(fields(cls), key=lambda declared: declared.name in ("amplitude", "mean"))
    required = {declared.name for declared in own if declared.default is MISSING} | {"amplitude"}
    return {declared.name: (SPECS[declared.name], declared.name in required) for declared in own}


def excitation_data(excitation: Excitation) -> dict[str, Any]:
    """The entry of a model file that makes this excitation."""
    data: dict[str, Any] = {"type": excitation.kind}
    for declared in fields(excitation):
        value = getattr(excitation, declared.name)
        if declared.name == "amplitude" or value != declared.default:
            data[declared.name] = SPECS[declared.name].plain(value)
    return data
