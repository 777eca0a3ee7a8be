"""JSON Schema of the output of every command with ``--json``."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from typing import Any

from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_rows import json_schema

OUTPUTS: dict[str, str] = {
    "angle": "torsionnet.app.cli.commands.angle:AngleRecord",
    "bench": "list[torsionnet.app.cli.commands.bench:BenchRecord]",
    "calibrate-wheel": "torsionnet.signals.rotation.calibration_record:CalibrationRecord",
    "campaign": "torsionnet.bench.campaign.campaign_json:CampaignJson",
    "check": "list[torsionnet.base.fault_rows:CheckRecord]",
    "compare": "torsionnet.app.cli.frf_output:ComparisonRecord",
    "clocks": "torsionnet.app.cli.commands.clocks:ClocksRecord",
    "critical-speeds": "list[torsionnet.machinery.criticals.critical_speeds:CriticalSpeedsRecord]",
    "damper": "list[torsionnet.machinery.design.damper_optimum:DamperRecord]",
    "damping": "torsionnet.modal.operational.operational_modes:OperationalModesRecord",
    "equations": "list[torsionnet.app.cli.equation_output:ConfiguredMotion|TransferFunctionRecord]",
    "estimate": "torsionnet.app.cli.frf_output:EstimateRecord",
    "fit": "torsionnet.identification.fit_record:FitRecord|RankingRecord",
    "frf": "list[torsionnet.app.cli.frf_output:ResponsesRecord]",
    "holzer": "list[torsionnet.machinery.holzer.holzer_table:HolzerRecord]",
    "identify-modes": "torsionnet.modal.matching:IdentifiedModesRecord",
    "library": "list[torsionnet.app.cli.commands.library:LibraryRow]",
    "limits": "list[torsionnet.machinery.verdicts.limit_conclusion:LimitsRecord]",
    "margins": "list[torsionnet.linear.responses.loop_margins:MarginsRecord]",
    "modes": "list[torsionnet.linear.modes.modes:ModesRecord]",
    "orders": "list[torsionnet.machinery.orders.orders_record:OrdersRecord]",
    "sensitivity": "list[torsionnet.linear.sensitivity.sensitivities_of_modes:SensitivityRecord]",
    "show": "list[torsionnet.app.cli.model_output:ShownModel]",
    "simulate": "list[torsionnet.motion.motion_summary:SimulationRecord]",
    "spectrogram": "list[torsionnet.signals.spectrograms:SpectrogramRecord]",
    "static": "list[torsionnet.machinery.mean.static_state:StaticRecord]",
    "study": "torsionnet.app.cli.study_output:study_schema",
    "track": "list[torsionnet.signals.orders.tracked_orders:TrackedOrdersRecord]",
}
"""Module and class of what each command prints with ``--json``, by command; list[...] has one for each
configuration."""


def output_schema(command: str) -> Schema:
    """JSON Schema of what a command prints with ``--json``."""
    place = OUTPUTS[command]
    module, names = place.removeprefix("list[").removesuffix("]").split(":")
    schemas = [_schema(getattr(import_module(module), name)) for name in names.split("|")]
    one: Schema = schemas[0] if len(schemas) == 1 else {"anyOf": schemas}
    return {"type": "array", "items": one} if place.startswith("list[") else one


def _schema(found: type | Callable[[], Schema]) -> Schema:
    return json_schema(found) if isinstance(found, type) else found()


def output_schema_text(command: str) -> str:
    """JSON Schema of what a command prints with ``--json``, as text."""
    head: dict[str, Any] = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"torsionnet {command} --json",
    }
    return json.dumps({**head, **output_schema(command)}, indent=1) + "\n"
