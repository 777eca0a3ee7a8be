"""Record of a study and what was concluded from it, as ``torsionnet study --json`` prints it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from torsionnet.base.entries.spec import Schema
from torsionnet.base.result_rows import Out, out_fields, record_schema, to_json
from torsionnet.study.run.answering import AnsweredStudy
from torsionnet.study.study import Study
from torsionnet.study.study_result import StatisticsRecord

AS_ANSWERED: Schema = {"description": "as the type of the answer has them"}
"""JSON Schema of the numbers in an answer of a study."""


@dataclass(frozen=True)
class ConclusionRow:
    """Conclusion of one answer of a study in sentences and numbers."""

    sentences: tuple[str, ...]
    numbers: Annotated[Any, Out(schema=AS_ANSWERED)]


@dataclass(frozen=True)
class StudyRecord:
    """Record of a study with its title, its answers, and why some could not be answered."""

    title: str
    answers: Mapping[str, ConclusionRow]
    unanswered: Annotated[Mapping[str, str] | None, Out(optional=True)]


def study_json(study: Study, answered: AnsweredStudy) -> dict[str, Any]:
    """JSON data of a study and its answers.

    Statistics of its variants, if it has any, between the title and the answers.
    """
    answers = {
        name: ConclusionRow(answered.sentences(name), one.to_data()) for name, one in answered.conclusions.items()
    }
    unanswered = {name: str(error) for name, error in answered.unanswered.items()}
    record = to_json(StudyRecord(study.title, answers, unanswered or None))
    statistics = {} if answered.result is None else answered.result.to_data()
    return {"title": study.title, **statistics, **record}


def study_schema() -> Schema:
    """JSON Schema of the data of a study that :func:`study_json` returns."""
    fields = (*out_fields(StatisticsRecord), *out_fields(StudyRecord))
    properties = {str(one.key): one.schema for one in fields}
    return record_schema(properties, optional=properties.keys() - {"title", "answers"})
