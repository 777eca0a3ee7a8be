"""JSON Schema of the ``report:`` section."""

from __future__ import annotations

from typing import Any

from torsionnet.model.report.report_reading import ANGLES
from torsionnet.model.report.sections import SECTIONS

Schema = dict[str, Any]
TEXTS = {
    "title": "title of the report; default: name of the model",
    "author": "who signs it",
    "notes": "remarks of the author, printed under the title",
}


def definitions() -> Schema:
    """Everything that the section refers to, by name."""
    return {"report": _section(), "report_transfer_function": _transfer_function()}


def _section() -> Schema:
    texts = {key: {"type": "string", "description": text} for key, text in TEXTS.items()}
    sections = [{"const": name, "description": text} for name, text in SECTIONS.items()]
    scalar = {"type": ["number", "string"]}
    return {
        "type": ["object", "null"],
        "description": "what torsionnet report writes about the model",
        "properties": {
            **texts,
            "sections": _list({"oneOf": sections}, "sections of the report; default: all that apply"),
            "transfer_functions": _list({"$ref": "#/$defs/report_transfer_function"}, "OUTPUT/INPUT, in this order"),
            "configurations": _list({"type": ["string", "number"]}, "configurations to report; default: all"),
            "band": {
                "description": "frequencies of the plots: 0.3..40 Hz or [0.3 Hz, 40 Hz]",
                "anyOf": [{"type": "string"}, {"type": "array", "items": scalar, "minItems": 2, "maxItems": 2}],
            },
            "angle": {"enum": list(ANGLES), "description": "unit of angles"},
        },
        "additionalProperties": False,
    }


def _list(items: Schema, description: str) -> Schema:
    return {"type": "array", "items": items, "description": description}


def _transfer_function() -> Schema:
    names = {
        "output": "sensor or node, or torque(element, port)",
        "input": "input or node, or a sensor: a measured input",
        "excitation": "what drives while the input is measured, if there are several inputs",
    }
    detailed = {
        "type": "object",
        "properties": {name: {"type": "string", "description": text} for name, text in names.items()},
        "required": ["output", "input"],
        "additionalProperties": False,
    }
    return {"anyOf": [{"type": "string", "description": "OUTPUT/INPUT, as theta_1/T_T"}, detailed]}
