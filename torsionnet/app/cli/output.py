"""Output of commands with ``--json`` as plain data, equations, models and studies, and the schema of all of it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, cast

from torsionnet.app.cli.command import with_configuration
from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_fields import json_schema, out_fields, record_schema, to_json
from torsionnet.base.result_rows import NUMBER, Out
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.matrices import SystemMatrices
from torsionnet.model.checks.values import parameter_units
from torsionnet.study.run.answering import AnsweredStudy
from torsionnet.study.study import Study
from torsionnet.study.study_result import StudyStatistics

# Equations of motion, matrices and transfer functions as plain data, for JSON.


@dataclass(frozen=True)
class EquationsOfMotion:
    """Equations of motion of a drivetrain as texts; the matrices by rows."""

    coordinates: tuple[str, ...]
    equations: tuple[str, ...]
    dependent: Mapping[str, str]
    conditions: tuple[str, ...]
    inertia: Annotated[list[list[str]], Out(json="M")]
    damping: Annotated[list[list[str]], Out(json="C")]
    stiffness: Annotated[list[list[str]], Out(json="K")]


SIMPLIFICATION_ERRORS = record_schema(dict.fromkeys(("omega", "zeta", "decibels"), NUMBER))
"""JSON Schema of the errors of a simplified drivetrain, relative ones and that of magnitudes in dB."""


@dataclass(frozen=True)
class WrittenTransferFunction:
    """Transfer function as text, as ``torsionnet equations --tf --json`` prints it, and what was left out of it."""

    transfer_function: str
    text: str
    left_out: Annotated[tuple[str, ...] | None, Out(optional=True)] = None
    band: Annotated[tuple[float, float] | None, Out(optional=True)] = None
    errors: Annotated[Any, Out(optional=True, schema=SIMPLIFICATION_ERRORS)] = None


def equations_of_motion(rig: Drivetrain) -> EquationsOfMotion:
    """Record with the equations of motion of a drivetrain as texts."""
    system = rig.symbolic()
    matrices = ([[str(cell) for cell in row] for row in getattr(system, symbol).tolist()] for symbol in "MCK")
    return EquationsOfMotion(
        system.coordinates,
        (*system.equations(), *system.laws()),
        dependent_angles(system),
        tuple(map(str, system.conditions)),
        *matrices,
    )


def static_matrices(rig: Drivetrain) -> SystemMatrices:
    """Matrices M, C and K of a drivetrain in SI units, in which laws over frequency and controllers have no part."""
    assembly, rows = rig.assembly, rig.assembly.system
    return SystemMatrices(assembly.kinematics.coordinates, assembly.nodes, rows.M, rows.C, rows.K, assembly.T)


def dependent_angles(system: Any) -> dict[str, str]:
    """Angles of the nodes that are no coordinates, as text in terms of the coordinates, by node."""
    angles = {}
    for row, node in enumerate(system.nodes):
        if node not in system.coordinates:
            terms = [
                _product(system.T[row, column], name)
                for column, name in enumerate(system.coordinates)
                if system.T[row, column] != 0
            ]
            angles[node] = " + ".join(terms) or "0"
    return angles


def matrix_rows(rig: Drivetrain, symbol: str) -> list[list[float]]:
    """Rows of numbers in SI units of the drivetrain's matrix M, C or K, shape (n_coordinates, n_coordinates)."""
    rows: list[list[float]] = getattr(rig.assembly.system, symbol).tolist()
    return rows


def _product(coefficient: Any, name: str) -> str:
    if coefficient == 1:
        return f"theta_{name}"
    return f"{coefficient} theta_{name}" if coefficient.is_Symbol else f"({coefficient}) theta_{name}"


# Model as ``torsionnet show --json`` prints it.

MODEL_FILE: Schema = {"type": "object", "description": "a model file, see torsionnet schema"}
"""JSON Schema of the content of a model file, which it does not check in detail."""


@dataclass(frozen=True)
class ResolvedParameter:
    """Value of a parameter in its SI unit, with the unit as text."""

    value: float
    unit: str


@dataclass(frozen=True)
class ShownModel:
    """Content of a model's file and its resolved values; equations of motion and matrices where these are asked for."""

    title: str
    configuration: str
    model: Annotated[Mapping[str, object], Out(schema=MODEL_FILE)]
    nodes: tuple[str, ...]
    parameters: Mapping[str, ResolvedParameter]
    mean_speeds: Annotated[Mapping[str, float], Out(json="mean_speeds_rad_per_s")]
    equations: Annotated[EquationsOfMotion | None, Out(optional=True)]
    matrices: Annotated[SystemMatrices | None, Out(optional=True)]


def shown_model(rig: Drivetrain, *, equations: bool, matrices: bool) -> ShownModel:
    """Model of one configuration as plain data, for JSON."""
    units = parameter_units(rig.definition)
    return ShownModel(
        rig.title,
        rig.configuration,
        model=rig.definition.flat_data(),
        nodes=rig.nodes,
        parameters={name: ResolvedParameter(value, units[name]) for name, value in rig.parameters.items()},
        mean_speeds=rig.mean_speeds,
        equations=equations_of_motion(rig) if equations else None,
        matrices=static_matrices(rig) if matrices else None,
    )


# Record of a study and what was concluded from it, as ``torsionnet study --json`` prints it.

AS_ANSWERED: Schema = {"description": "as the type of the answer has them"}
"""JSON Schema of the numbers in an answer of a study."""


@dataclass(frozen=True)
class WordedConclusion:
    """Conclusion of one answer of a study in sentences and numbers."""

    sentences: tuple[str, ...]
    numbers: Annotated[Any, Out(schema=AS_ANSWERED)]


@dataclass(frozen=True)
class StudyAnswers:
    """Record of a study with its title, its answers, and why some could not be answered."""

    title: str
    answers: Mapping[str, WordedConclusion]
    unanswered: Annotated[Mapping[str, str] | None, Out(optional=True)]


def study_json(study: Study, answered: AnsweredStudy) -> dict[str, Any]:
    """JSON data of a study and its answers.

    Statistics of its variants, if it has any, between the title and the answers.
    """
    answers = {
        name: WordedConclusion(answered.sentences(name), conclusion.to_data())
        for name, conclusion in answered.conclusions.items()
    }
    unanswered = {name: str(error) for name, error in answered.unanswered.items()}
    record = to_json(StudyAnswers(study.title, answers, unanswered or None))
    statistics = {} if answered.result is None else answered.result.to_data()
    return {"title": study.title, **statistics, **record}


def study_schema() -> Schema:
    """JSON Schema of the data of a study that :func:`study_json` returns."""
    fields = (*out_fields(StudyStatistics), *out_fields(StudyAnswers))
    properties = {str(field.key): field.schema() for field in fields}
    return record_schema(properties, optional=properties.keys() - {"title", "answers"})


# JSON Schema of the output of every command with ``--json``.

OUTPUTS: dict[str, str] = {
    "angle": "torsionnet.app.cli.commands.wheels:TurnedWheels",
    "bench": "list[torsionnet.app.cli.commands.bench_and_campaign:BenchRun]",
    "calibrate-wheel": "torsionnet.signals.rotation.pulse_deviations:WheelCalibration",
    "campaign": "torsionnet.bench.campaign.running_campaign:CampaignResult",
    "check": "list[torsionnet.base.plain_faults:CheckedModel]",
    "compare": "torsionnet.app.cli.commands.estimate:ComparedCurves|SteppedComparison without static, peaks",
    "clocks": "torsionnet.signals.rotation.clock_drift:ClockDrift",
    "critical-speeds": "list[torsionnet.machinery.criticals.critical_speeds:CriticalSpeeds]",
    "damper": "list[torsionnet.machinery.design.damper_optimum:DamperOptimum]",
    "damping": "torsionnet.modal.operational.ambient_modes:OperationalModes",
    "equations": "configured[torsionnet.app.cli.output:EquationsOfMotion|WrittenTransferFunction]",
    "estimate": "torsionnet.app.cli.frf_output:ResponseCurves or torsionnet.signals.stepped_levels:SteppedStiffness "
    "without static, peaks",
    "fit": "torsionnet.identification.ranking:FitAnswer|Ranking",
    "frf": "configured[torsionnet.app.cli.frf_output:ResponseCurves without usable_up_to, coherence]",
    "holzer": "list[torsionnet.machinery.holzer.holzer_table:HolzerTable]",
    "identify-modes": "torsionnet.modal.modal_estimate:ModalEstimate",
    "library": "list[torsionnet.app.cli.commands.model_files:LibraryFile]",
    "limits": "list[torsionnet.machinery.verdicts.limit_conclusion:ConcludedCheck]",
    "loops": "torsionnet.signals.torque_loops.loop_result:TorqueLoops",
    "margins": "configured[torsionnet.linear.responses.loop_margins:LoopMargins]",
    "modes": "configured[torsionnet.linear.modes.modes:Modes]",
    "orders": "list[torsionnet.machinery.orders.orders_over_speed:OrdersOverSpeed]",
    "periodic": "configured[torsionnet.motion.periodic.periodic_result:PeriodicResponse]",
    "sensitivity": "configured[torsionnet.linear.sensitivity.sensitivities_of_modes:ModeSensitivities]",
    "show": "list[torsionnet.app.cli.output:ShownModel]",
    "simulate": "list[torsionnet.motion.motion_record:SimulatedMotion]",
    "spectrogram": "list[torsionnet.signals.spectra:Spectrogram]",
    "static": "list[torsionnet.machinery.mean.static_state:StaticState]",
    "study": "torsionnet.app.cli.output:study_schema",
    "track": "list[torsionnet.signals.orders.tracked_orders:TrackedOrders]",
}
"""Module and class of what each command prints with ``--json``, by command; list[...] has one for each
configuration, configured[...] also puts its name in; "or" and "|" part what options choose from, in several modules or
in one; fields behind "without" are left out."""
WRITTEN = re.compile(r"(?:(?P<each>list|configured)\[)?(?P<places>.*?)(?: without (?P<without>[^]]*))?\]?")
"""Form of a line of ``OUTPUTS``."""


def output_kinds(command: str) -> list[type | Callable[[], Schema]]:
    """Classes of what a command prints with ``--json``, or functions that return its schema."""
    places = [place.split(":") for place in _written(command)["places"].split(" or ")]
    return [getattr(import_module(module), name) for module, names in places for name in names.split("|")]


def _written(command: str) -> Mapping[str, str]:
    written = WRITTEN.fullmatch(OUTPUTS[command])
    assert written
    return written.groupdict("")


def output_schema(command: str) -> Schema:
    """JSON Schema of what a command prints with ``--json``."""
    written, kinds = _written(command), output_kinds(command)
    without = written["without"].split(", ")
    schemas = [json_schema(kind, without) if isinstance(kind, type) else kind() for kind in kinds]
    if written["each"] == "configured":
        schemas = [_configured(schema) for schema in schemas]
    schema: Schema = schemas[0] if len(schemas) == 1 else {"anyOf": schemas}
    return {"type": "array", "items": schema} if written["each"] else schema


def _configured(schema: Schema) -> Schema:
    """JSON Schema of a result into which the name of its configuration is put."""
    properties, required = cast("dict[str, Schema]", schema["properties"]), cast("list[str]", schema["required"])
    return record_schema(with_configuration(properties, json_schema(str)), properties.keys() - set(required))


def output_schema_text(command: str) -> str:
    """JSON Schema of what a command prints with ``--json``, as text."""
    head: dict[str, Any] = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"torsionnet {command} --json",
    }
    return json.dumps({**head, **output_schema(command)}, indent=1) + "\n"
