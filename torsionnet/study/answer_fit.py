"""Whether what the answers of a study ask can be answered by it, as far as it is sound."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault
from torsionnet.study.answers.answer import ANSWERS, AskedStudy, StudyAnswer
from torsionnet.study.answers.answer_names import CONFIGURATION, LIMIT, PARAMETER, QUANTITY, VARIED, misnamed
from torsionnet.study.examined_study import ExaminedStudy


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
