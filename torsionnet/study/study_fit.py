"""Whether what a study asks can be answered by its model in every configuration."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from torsionnet.core.errors import Fault, did_you_mean
from torsionnet.drivetrain import Drivetrain
from torsionnet.study.answers.answer import ANSWERS, AskedStudy, StudyAnswer
from torsionnet.study.answers.asking import CONFIGURATION, LIMIT, PARAMETER, QUANTITY, VARIED, misnamed
from torsionnet.study.examined_study import ExaminedStudy
from torsionnet.study.quantities.quantity import StudyQuantity
from torsionnet.study.quantities.quantity_limit import QuantityLimit, wrong_unit


def misnamed_in_answers(read: ExaminedStudy) -> list[Fault]:
    """Names that the study does not have, in answers with other faults too; what is named may have faults itself."""
    known = {
        QUANTITY: read.named("quantities"),
        LIMIT: read.named("limits"),
        VARIED: read.named("vary"),
        PARAMETER: list(read.model.parameters),
        CONFIGURATION: list(read.configurations),
    }
    faults = []
    for name, raw in _answers(read.given):
        kind, entries = _kind_and_entries(raw)
        if kind is not None:
            faults += [fault.under("answers", name) for fault in misnamed(kind.naming, entries, known)]
    return faults


def _answers(given: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    answers = given.get("answers")
    if isinstance(answers, Mapping):
        yield from answers.items()


def _kind_and_entries(raw: Any) -> tuple[type[StudyAnswer] | None, Mapping[str, Any]]:
    """The class of an answer and its entries, as they are written or as Python made them."""
    if isinstance(raw, StudyAnswer):
        return type(raw), {key: getattr(raw, key, None) for key in raw.naming}
    kind = raw.get("type") if isinstance(raw, Mapping) else None
    return (ANSWERS[kind], raw) if isinstance(kind, str) and kind in ANSWERS else (None, {})


def unfit_answers(study: AskedStudy, answers: Mapping[str, StudyAnswer], *, is_whole: bool) -> list[Fault]:
    """What does not fit in answers that could be read.

    Of a study that is not whole they are told what is wrong with single entries only: what an answer lacks altogether
    may be what has a fault.
    """
    faults = [fault.under("answers", name) for name, one in answers.items() for fault in one.unfit(study)]
    return faults if is_whole else [fault for fault in faults if len(fault.path) > 2]


RESERVED = {name: f"what labels of results call the {name}" for name in ("configuration", "variant", "percentile")}


def taken_names(quantities: Iterable[Any], parameters: Iterable[Any]) -> list[Fault]:
    """Quantities with the name of a column of something else, which would take its place in tables of variants."""
    meanings = dict.fromkeys(parameters, "a parameter that varies") | RESERVED
    return [
        Fault(f'"{name}" is {meanings[name]}; give the quantity another name', ("quantities", name), on_key=True)
        for name in quantities
        if name in meanings
    ]


def unknown_limits(limits: Iterable[Any], quantities: Iterable[Any]) -> list[Fault]:
    """Faults of limits of quantities that are none."""
    known = [str(name) for name in quantities]
    return [
        Fault(
            f'no quantity is named "{name}"{did_you_mean(str(name), known)}; known: {", ".join(known)}',
            ("limits", name),
            on_key=True,
        )
        for name in limits
        if str(name) not in known
    ]


def lacking(model: Drivetrain, configurations: Sequence[str], quantities: Mapping[str, StudyQuantity]) -> list[Fault]:
    """Faults of quantities that a configuration lacks."""
    found: dict[tuple[object, str], list[tuple[str, Fault]]] = {}
    for configuration in configurations:
        here = model.configured(configuration) if configuration else model
        for name, quantity in quantities.items():
            for fault in quantity.unfit(here, quantities):
                placed = fault.under("quantities", name)
                found.setdefault((placed.path, placed.message), []).append((configuration, placed))
    return [_said(same, len(configurations)) for same in found.values()]


def wrong_units(
    model: Drivetrain,
    configurations: Sequence[str],
    quantities: Mapping[str, StudyQuantity],
    limits: Mapping[str, QuantityLimit],
) -> list[Fault]:
    """Limits in units in which their quantity is not."""
    here = model.configured(configurations[0]) if configurations and configurations[0] else model
    faults: list[Fault] = []
    for name, limit in limits.items():
        unit = quantities[name].measured(here, quantities).unit
        for key in ("below", "above"):
            faults += wrong_unit(getattr(limit, key), name, unit, ("limits", name, key))
    return faults


def _said(same: Sequence[tuple[str, Fault]], count: int) -> Fault:
    """A fault once, with the configurations that have it where others have not."""
    names, fault = [name for name, _ in same if name], same[0][1]
    return fault if len(same) == count or not names else replace(fault, configuration=", ".join(names))
