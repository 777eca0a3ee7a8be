"""The JSON Schema of model files, made from the specifications of the element types.

Editors complete, explain and check a model file with it (``# yaml-language-server: $schema=torsionnet.schema.json``);
what needs more than one entry at a time (names, dimensions, connections) is left to ``torsionnet check``.
"""

from __future__ import annotations

import json
from dataclasses import MISSING, Field
from typing import Any

from torsionnet.model.bench.bench_schema import definitions as bench_definitions
from torsionnet.model.channels import INPUT_QUANTITIES, SENSOR_QUANTITIES
from torsionnet.model.definition import VERSION
from torsionnet.model.elements import ELEMENT_TYPES, Element
from torsionnet.model.elements.fields import SCALAR_SCHEMA, spec_of
from torsionnet.model.report.report_schema import definitions as report_definitions

Schema = dict[str, Any]

DRAFT = "https://json-schema.org/draft/2020-12/schema"
NAME = {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}
SCALAR = {**SCALAR_SCHEMA, "description": "a number in SI units, a value with unit, or an expression of parameters"}


def json_schema() -> Schema:
    """The JSON Schema (draft 2020-12) of a model file."""
    kinds = {f"element_{kind}": _element(cls) for kind, cls in ELEMENT_TYPES.items()}
    return {
        "$schema": DRAFT,
        "title": "torsionnet model",
        "description": "A lumped-parameter torsional model of a drivetrain, or a test bench that names its model.",
        "type": "object",
        "properties": _entries(),
        "required": ["torsionnet"],
        "oneOf": [{"required": ["elements"]}, {"required": ["model", "bench"]}],
        "additionalProperties": False,
        "$defs": {
            "scalar": SCALAR,
            "parameter": _parameter(),
            "element": _any_element(),
            **kinds,
            "input": _channel(INPUT_QUANTITIES, "{torque: node} or {angle: node}"),
            "sensor": _sensor(),
            "operating_point": _operating_point(),
            "alternative": _alternative(),
            "axis": _table("alternative", "the alternatives on this axis, by name"),
            **bench_definitions(),
            **report_definitions(),
        },
    }


def schema_text() -> str:
    """The schema as the text of ``library/torsionnet.schema.json``."""
    return json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n"


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}


def _text(description: str) -> Schema:
    return {"type": "string", "description": description}


def _table(entry: str, description: str, **more: Any) -> Schema:
    return {"type": ["object", "null"], "description": description, "additionalProperties": _ref(entry), **more}


def _entries() -> Schema:
    elements = _table("element", "the parts of the drivetrain by name, each attached to nodes", propertyNames=NAME)
    return {
        "torsionnet": {"const": VERSION, "description": "version of the file format"},
        "name": _text("title of the model"),
        "source": _text("where the numbers come from"),
        "description": _text("what the model is"),
        "parameters": _table(
            "parameter", "named values with unit, or expressions of other parameters", propertyNames=NAME
        ),
        "elements": {**elements, "type": "object", "minProperties": 1},
        "inputs": _table("input", "excitations by name", propertyNames=NAME),
        "sensors": _table("sensor", "measured quantities by name", propertyNames=NAME),
        "configurations": {
            "description": "axes of alternatives, gear: {II: {tau: 7.96}}; the name of a single axis may be left out",
            "anyOf": [_table("axis", "axes by name"), _table("alternative", "alternatives by name")],
        },
        "operating_point": {
            **_ref("operating_point"),
            "description": "mean speeds and torques the model is linear about",
        },
        "bench": _ref("bench"),
        "report": _ref("report"),
        "model": _text("of a file with a bench and no elements: name of a library model, or path of a model file"),
        "configuration": _text("of a file with a bench and no elements: configuration in which the model is tested"),
    }


def _parameter() -> Schema:
    bounds = {
        "type": "array",
        "items": _ref("scalar"),
        "minItems": 2,
        "maxItems": 2,
        "description": "[lower, upper]: what is plausible; limits of a fit",
    }
    detailed = {
        "type": "object",
        "properties": {"value": _ref("scalar"), "description": _text("what the parameter is"), "bounds": bounds},
        "required": ["value"],
        "additionalProperties": False,
    }
    return {"anyOf": [_ref("scalar"), detailed]}


def _any_element() -> Schema:
    """One rule for each type, so that a fault is reported against the type that was meant."""
    known = {"enum": list(ELEMENT_TYPES), "description": "what kind of element this is"}
    rules = [
        {"if": {"properties": {"type": {"const": kind}}, "required": ["type"]}, "then": _ref(f"element_{kind}")}
        for kind in ELEMENT_TYPES
    ]
    return {"type": "object", "properties": {"type": known}, "required": ["type"], "allOf": rules}


def _element(cls: type[Element]) -> Schema:
    summary = (cls.__doc__ or "").strip().splitlines()[0]
    properties = {declared.name: _field(declared) for declared in cls.declared()}
    required = [declared.name for declared in cls.declared() if declared.default is MISSING]
    return {
        "title": cls.kind,
        "description": summary,
        "type": "object",
        "properties": {"type": {"const": cls.kind, "description": summary}, **properties},
        "required": ["type", *required],
        "additionalProperties": False,
    }


def _field(declared: Field[Any]) -> Schema:
    schema = spec_of(declared).schema()
    return schema if declared.default in (MISSING, None) else {**schema, "default": declared.default}


def _channel(quantities: tuple[str, ...], example: str) -> Schema:
    return {
        "type": "object",
        "description": example,
        "properties": {quantity: _text(f"where the {quantity} acts or is measured") for quantity in quantities},
        "oneOf": [{"required": [quantity]} for quantity in quantities],
        "additionalProperties": False,
    }


def _sensor() -> Schema:
    schema = _channel(SENSOR_QUANTITIES, "{angle: node}, {twist: element} or {torque: element, at: node}")
    schema["properties"]["at"] = _text("the port, or its node, where a torque is taken")
    return {**schema, "dependentRequired": {"at": ["torque"]}}


def _operating_point() -> Schema:
    tables = {"speed": "mean speed by node, as 1500 rpm", "torque": "mean external torque by node, as 80 N*m"}
    properties = {name: _table("scalar", text) for name, text in tables.items()}
    return {"type": ["object", "null"], "properties": properties, "additionalProperties": False}


def _alternative() -> Schema:
    names = {"type": "array", "items": {"type": "string"}}
    return {
        "type": ["object", "null"],
        "description": "changed parameters, and elements switched on or off",
        "properties": {
            "on": {**names, "description": "elements to switch on"},
            "off": {**names, "description": "elements to switch off"},
            "operating_point": _ref("operating_point"),
        },
        "additionalProperties": _ref("scalar"),
    }
