"""JSON Schema of the ``bench:`` section, from the specifications of its parts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING
from typing import Any

from torsionnet.model.bench.excitations import EXCITATIONS, specs_of
from torsionnet.model.bench.fields import BenchPart
from torsionnet.model.bench.parts import SENSORS, Acquisition, Exciter
from torsionnet.model.elements.fields import Spec, spec_of

Schema = dict[str, Any]


def definitions() -> Schema:
    """Everything that the section refers to, by name."""
    excitations = {_key(kind): _entry(kind, specs_of(cls), typed=True) for kind, cls in EXCITATIONS.items()}
    sensors = {_key(kind): _entry(kind, _specs(cls), typed=True) for kind, cls in SENSORS.items()}
    return {
        "bench": _section(),
        "bench_excitation": _any(EXCITATIONS, "what the torque is to be"),
        "bench_channel": _any(SENSORS, "a sensor and its errors"),
        "bench_exciter": _entry("exciter", _specs(Exciter), typed=False),
        "bench_acquisition": _entry("acquisition", _specs(Acquisition), typed=False),
        **excitations,
        **sensors,
    }


def _section() -> Schema:
    channels = {"type": "object", "additionalProperties": _ref("bench_channel"), "minProperties": 1}
    return {
        "type": ["object", "null"],
        "description": "a virtual test: excitation, exciter, sensors, data acquisition",
        "properties": {
            "drive": {"type": "string", "description": "input on which the torque acts, if there are several"},
            "excitation": _ref("bench_excitation"),
            "exciter": _ref("bench_exciter"),
            "channels": {**channels, "description": "what is recorded, by the name of a sensor"},
            "acquisition": _ref("bench_acquisition"),
            "seed": {"type": "integer", "minimum": 0, "description": "the same seed gives the same record"},
        },
        "required": ["excitation", "channels", "acquisition"],
        "additionalProperties": False,
    }


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}


def _key(kind: str) -> str:
    return f"bench_{kind.replace(' ', '_')}"


def _specs(cls: type[BenchPart]) -> dict[str, tuple[Spec, bool]]:
    return {declared.name: (spec_of(declared), declared.default is MISSING) for declared in cls.declared()}


def _entry(kind: str, specs: Mapping[str, tuple[Spec, bool]], *, typed: bool) -> Schema:
    head: Schema = {"type": {"const": kind, "description": kind}} if typed else {}
    return {
        "title": kind,
        "type": "object",
        "properties": head | {name: spec.schema() for name, (spec, _) in specs.items()},
        "required": [*head, *(name for name, (_, required) in specs.items() if required)],
        "additionalProperties": False,
    }


def _any(kinds: Mapping[str, Any], description: str) -> Schema:
    known = {"enum": list(kinds), "description": description}
    rules = [
        {"if": {"properties": {"type": {"const": kind}}, "required": ["type"]}, "then": _ref(_key(kind))}
        for kind in kinds
    ]
    return {"type": "object", "properties": {"type": known}, "required": ["type"], "allOf": rules}
