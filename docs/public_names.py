"""Public names of the package, results, the members of both, their signatures, and the options of all commands.

``python docs/public_names.py`` (``make signatures``) writes the list of signatures, with which ``make lint`` compares.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import cached_property
from inspect import Parameter, getdoc, isclass, ismodule, isroutine, signature
from pathlib import Path
from typing import Any

import torsionnet as tn
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Spec
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import TABLES, LazyMethod, NotebookResult

SIGNATURES = Path(__file__).parents[1] / "tests" / "public_signatures.txt"
HEAD = "# Public names and signatures: a change is a decision (docs/stability.md). Written by `make signatures`.\n"
INNER_BASES = (Declared, NotebookResult)
"""Base classes whose own members are for the package alone: how entries are read, what a notebook asks for."""
_SCENARIO = ("begins", "course", "expressions", "length", "name_faults", "needed", "places", "schema", "words")
RESULTS: dict[str, str] = {
    "torsionnet.base.errors": "Position",
    "torsionnet.base.table": "Column",
    "torsionnet.bench.bench": "TurningTest",
    "torsionnet.bench.campaign.campaign": "Campaign",
    "torsionnet.bench.campaign.running_campaign": "CampaignResult ConditionSpread",
    "torsionnet.bench.recorded_signal": "ExciterOutput",
    "torsionnet.bench.wheel_turning": "TrueFault",
    "torsionnet.identification.fit_result": "Compared",
    "torsionnet.identification.lack_of_fit": "Explanation LackOfFit Misfit",
    "torsionnet.identification.ranking": "Choice RankedCause Ranking",
    "torsionnet.linear.assembly.matrices": "SystemMatrices",
    "torsionnet.linear.between_samples": "BetweenSamples",
    "torsionnet.linear.estimation": "Estimation",
    "torsionnet.linear.modes.mode_pairs": "VibrationMode",
    "torsionnet.linear.modes.modes": "ModeRow",
    "torsionnet.linear.responses.loop_margins": "LoopMargins Margin",
    "torsionnet.linear.responses.shared_response": "FrequencyResponses",
    "torsionnet.linear.sensitivity.sensitivities_of_modes": "ModeEffect ModeSensitivities",
    "torsionnet.machinery.criticals.critical_speeds": "CriticalSpeed CriticalSpeeds SpeedPeak",
    "torsionnet.machinery.design.damper_optimum": "DamperOptimum DesignParameter",
    "torsionnet.machinery.holzer.holzer_table": "HolzerBranch HolzerLink HolzerStation HolzerTable",
    "torsionnet.machinery.holzer.mass_elastic_table": "MassElasticLine MassElasticRow MassElasticShaft "
    "MassElasticTable StationSection",
    "torsionnet.machinery.mean.static_state": "DissipatedPower ElementLoad PowerBalance StaticState",
    "torsionnet.machinery.mean.mean_solution": "MeanResponse",
    "torsionnet.machinery.orders.order_line": "OrderLine",
    "torsionnet.machinery.orders.order_response": "OrderResponse",
    "torsionnet.machinery.passage.passage_response": "PassagePeak PassageResponse",
    "torsionnet.machinery.orders.vector_sums": "StarDiagram",
    "torsionnet.machinery.verdicts.limit_check": "LimitCheck",
    "torsionnet.machinery.verdicts.limit_verdict": "LimitVerdict RuleText",
    "torsionnet.machinery.verdicts.limit_conclusion": "WorstLimit",
    "torsionnet.machinery.verdicts.speed_spans": "SpeedSpan",
    "torsionnet.modal.circle_fitting": "CircleFit",
    "torsionnet.modal.matching": "Match",
    "torsionnet.modal.modal_estimate": "IdentifiedMode ModalEstimate",
    "torsionnet.modal.operational.ambient_modes": "OperationalMode OperationalModes",
    "torsionnet.modal.operational.run_up_fit": "SpeedSweep",
    "torsionnet.modal.spectral_lines": "Criteria",
    "torsionnet.modal.matrix_fraction": "Order Stabilisation",
    "torsionnet.model.catalogues.catalogue": "Catalogue",
    "torsionnet.model.channels": "Input Sensor",
    "torsionnet.model.parameters": "Parameter",
    "torsionnet.model.sheets.mass_elastic_sheet": "MassElasticSheet",
    "torsionnet.motion.periodic.periodic_result": "PeriodicResponse",
    "torsionnet.report.document_tree": "Picture Report",
    "torsionnet.signals.comparison": "Difference",
    "torsionnet.signals.orders.mean_rotation": "MeanRotation",
    "torsionnet.signals.orders.tracked_orders": "TrackedOrders TrackingKernel",
    "torsionnet.signals.pulses": "MissingPulses Pulses",
    "torsionnet.signals.recording": "MotionEvent",
    "torsionnet.signals.rotation.pulse_deviations": "WheelCalibration",
    "torsionnet.signals.rotation.clock_drift": "ClockDrift",
    "torsionnet.signals.rotation.pitch_order": "PitchOrder",
    "torsionnet.signals.rotation.wheel_rotation": "WheelRotation",
    "torsionnet.signals.spectra": "Spectrogram",
    "torsionnet.signals.torque_loops.loop_result": "LoopStage LoopValue TorqueLoop TorqueLoops",
    "torsionnet.signals.stepped_levels": "SteppedStiffness",
    "torsionnet.study.design.best_damper": "DamperInCondition",
    "torsionnet.study.quantities.expression": "UserFunction",
    "torsionnet.study.reductions.summaries": "Summary",
    "torsionnet.study.run.answering": "AnsweredStudy",
    "torsionnet.study.study": "ShownUnits Study",
    "torsionnet.study.space.samples": "Samples",
    "torsionnet.study.space.space": "Space",
    "torsionnet.study.study_result": "StudyResult",
    "torsionnet.symbolic.normalised": "Expanded Normalised",
    "torsionnet.symbolic.rational": "Rational",
    "torsionnet.symbolic.simplified": "Simplified",
    "torsionnet.symbolic.symbolic_system": "SymbolicSystem",
    "torsionnet.symbolic.transfer_function": "TransferFunction",
    "torsionnet.symbolic.transfer_matrix": "TransferMatrix",
}
"""Results: classes by their modules of which public names return or hold objects, and that no program makes itself.

Their fields and members are public, the modules are not.
"""
_RESULTS = {
    name: getattr(importlib.import_module(module), name) for module, names in RESULTS.items() for name in names.split()
}
INNER_MEMBERS: dict[type, set[str]] = {
    object: {"contradictions", "key_faults", "notebook_tables", "record", "renamed", "row"},
    tn.Drivetrain: {"assembly", "at_point", "definition", "from_definition", "with_definition", "with_entries_named"},
    tn.Element: {
        *("diameters", "expanded", "expressions", "from_entries", "is_at_own_speed", "mean_speed_rows", "other_laws"),
        *("own_parts", "own_tangent_parts", "own_whole_parts", "parts", "place_of", "reads_off", "referral_fault"),
        *("scalars", "schema", "sign_at", "twist", "with_laws"),
    },
    _RESULTS["Parameter"]: {"given", "with_operating_values", "written"},
    tn.TorqueScenario: {*_SCENARIO, "histories", "read_entries", "to_data"},
    tn.ShortCircuitScenario: {*_SCENARIO, "torque", "what"},
    _RESULTS["OrderResponse"]: {"engine_notes", "no_cycle", "unmet"},
    _RESULTS["CriticalSpeed"]: {"star_vectors"},
    _RESULTS["CriticalSpeeds"]: {"margin_rule", "modes_with_shapes"},
    _RESULTS["DamperOptimum"]: {"output", "over", "unit"},
    _RESULTS["LimitCheck"]: {"barred_rpm", "findings", "highest", "passed"},
    tn.machinery.LimitConclusion: {"barred_rpm", "findings", "worst_table"},
    _RESULTS["LimitVerdict"]: {"barred_rpm", "highest_rpm", "worst_unit"},
    _RESULTS["StaticState"]: {"external_torques"},
    _RESULTS["Study"]: {"entries", "evaluator", "model_in", "model_text"},
    tn.study.Workers: {"executor"},
    _RESULTS["Samples"]: {"points"},
    tn.study.Normal: {"bound", "sizes", "words"},
    _RESULTS["UserFunction"]: {*dir(_RESULTS["UserFunction"])},
    _RESULTS["TransferFunction"]: {
        "free_symbols",
        "nested_leaves",
        "predicted_terms",
        "program",
        "steps",
        "used_tables",
    },
}
"""Members of public classes, and of what inherits from them, that only the package itself calls."""
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")


@dataclass(frozen=True)
class PublicName:
    """Public object with the name under which the documentation has it, and its other public names."""

    name: str
    value: Any
    others: tuple[str, ...] = ()

    @property
    def is_class(self) -> bool:
        return isclass(self.value)

    @property
    def is_result(self) -> bool:
        """Whether it is a class of which programs only get objects."""
        return self.value is _RESULTS.get(self.last)

    @property
    def last(self) -> str:
        """Name without the package."""
        return self.name.rpartition(".")[2]

    @property
    def summary(self) -> str:
        """First sentence of its docstring."""
        if not (self.is_class or callable(self.value)):
            return ""
        text = (getdoc(self.value) or "").partition("\n\n")[0]
        return re.split(r"(?<=[.:])\s+(?=[A-Z`])", " ".join(text.split()))[0]

    @property
    def inner_members(self) -> set[str]:
        """Names of members of a class that only the package itself calls."""
        return {name for cls, names in INNER_MEMBERS.items() if issubclass(self.value, cls) for name in names}

    @cached_property
    def members(self) -> dict[str, Any]:
        """Public members of a class that have a docstring, by name, those of base classes included."""
        found: dict[str, Any] = {}
        inner_kinds = tn.Element, Spec, Expression
        if not self.is_class or (issubclass(self.value, inner_kinds) and self.value is not tn.Element):
            return found  # an element type has entries; what else there is, its base class has
        hidden, inner = self.inner_members, {*INNER_BASES}
        for cls in self.value.__mro__:
            if not cls.__module__.startswith("torsionnet") or cls in inner:
                continue
            for name, member in vars(cls).items():
                if name.startswith("_") or name in hidden or name in found or isclass(member):
                    continue
                if isinstance(member, property | cached_property | classmethod | staticmethod) or isroutine(member):
                    found[name] = member
        return found


def public_packages() -> list[str]:
    """Modules from which programs may import, the package itself first."""
    offered = [one for one in TABLES["torsionnet"].values() if ":" not in one]
    return ["torsionnet", *sorted(offered)]


def public_names() -> list[PublicName]:
    """Every public object once, sorted by name, element types, modules' contents and results included."""
    named: dict[int, tuple[Any, list[str]]] = {}
    for package in public_packages():
        module = importlib.import_module(package)
        for name in module.__all__:
            value = getattr(module, name)
            if not ismodule(value) and name != "__version__":
                named.setdefault(id(value), (value, []))[1].append(f"{package}.{name}")
    found = [PublicName(names[0], value, tuple(names[1:])) for value, names in named.values()]
    found += [
        PublicName(f"{module}.{name}", _RESULTS[name]) for module, names in RESULTS.items() for name in names.split()
    ]
    return sorted(found, key=lambda one: one.name)


# Signatures


def signature_lines() -> list[str]:
    """Sorted lines with the signature of every public object, parameter of a class, and member."""
    return sorted(line for one in public_names() for line in _lines(one))


def _lines(one: PublicName) -> Iterator[str]:
    yield from (f"{other} = {one.name}" for other in one.others)
    if not one.is_class:
        yield f"{one.name}{_call(one.value)}" if callable(one.value) else f"{one.name}: {type(one.value).__name__}"
        return
    bases = [
        base.__name__ for base in one.value.__mro__[1:-1] if base.__module__ in ("builtins", "torsionnet.base.errors")
    ]
    yield f"{one.name}: class({', '.join(bases)})"
    if not issubclass(one.value, BaseException):
        yield from _parameters(one)
    for name, member in one.members.items():
        yield f"{one.name}.{name}{_member(member)}"


def _parameters(one: PublicName) -> Iterator[str]:
    """Lines with the parameters of a class, numbered where they may be given by position, and its other fields."""
    given = {} if one.is_result else signature(one.value).parameters
    for number, (name, parameter) in enumerate(given.items(), 1):
        place = "by name" if parameter.kind is Parameter.KEYWORD_ONLY else f"number {number:02}"
        yield f"{one.name}({place} {_parameter(name, parameter)})"
    if is_dataclass(one.value):
        for field in fields(one.value):
            if field.name not in {*given, *one.inner_members} and not field.name.startswith("_"):
                yield f"{one.name}.{field.name}: {_annotation(field.type)}"


def _member(member: Any) -> str:
    if isinstance(member, property | cached_property):
        function = member.fget if isinstance(member, property) else member.func
        return f" -> {_annotation(signature(function).return_annotation)}"
    if isinstance(member, LazyMethod):  # a solver, whose first parameter is the object
        return re.sub(r"^\(\w+: \w+", "(self", _call(member.__get__(None)))
    kind = " classmethod" if isinstance(member, classmethod) else ""
    return _call(getattr(member, "__func__", member)) + kind


def _call(function: Any) -> str:
    try:
        found = signature(function)
    except ValueError:  # of a builtin
        return "(...)"
    shown, starred = [], False
    for name, parameter in found.parameters.items():
        if parameter.kind is Parameter.KEYWORD_ONLY and not starred:
            shown.append("*")
            starred = True
        starred |= parameter.kind is Parameter.VAR_POSITIONAL
        stars = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        shown.append(stars + _parameter(name, parameter))
    return f"({', '.join(shown)}) -> {_annotation(found.return_annotation)}"


def _parameter(name: str, parameter: Parameter) -> str:
    annotation = "" if parameter.annotation is Parameter.empty else f": {_annotation(parameter.annotation)}"
    if parameter.default is Parameter.empty:
        return f"{name}{annotation}"
    default = "..." if parameter.default is MISSING else _ADDRESS.sub("", repr(parameter.default))
    return f"{name}{annotation} = {' '.join(default.split())}"


def _annotation(annotation: Any) -> str:
    if annotation is Parameter.empty:
        return "?"
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))


def option_lines() -> list[str]:
    """Lines with every argument and option of every command, what it takes, and its default."""
    group = importlib.import_module("torsionnet.app.cli.app").app
    return [
        f"torsionnet {name} {' '.join(one.opts)}{_taken(one.to_info_dict())}"
        for name in sorted(group.list_commands(None))
        for one in group.get_command(None, name).params
    ]


def _taken(option: dict[str, Any]) -> str:
    kind = option["type"]
    words = [" ".join(kind["choices"]) if "choices" in kind else kind["name"]]
    if "min" in kind:
        words += [
            f"{'>' if kind['min_open'] else '>='} {kind['min']}",
            f"{'<' if kind['max_open'] else '<='} {kind['max']}",
        ]
    words += [word for word in ("required", "multiple") if option[word]]
    words += [f"{option['nargs']} values"] if option["nargs"] != 1 else []
    given = option["default"]  # without one, versions of click have different words for it
    return f": {', '.join(words)}" + (f" = {given}" if isinstance(given, str | int | float | tuple) and given else "")


def signatures_text() -> str:
    """Text of the stored list."""
    return HEAD + "".join(f"{line}\n" for line in (*signature_lines(), *option_lines()))


if __name__ == "__main__":
    SIGNATURES.write_text(signatures_text(), encoding="utf-8")
