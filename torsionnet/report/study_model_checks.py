"""Check that the studies shown in a report are of the model that the report is on."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import UsageError, comma_list

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.study.study import Study

IGNORED_ENTRIES = ("report", "description", "source")
"""Names of model entries that no result depends on."""
MOST_DIFFERENCES = 6
"""Largest number of differing entries that an error message names."""


def check_study_models(model: Drivetrain, studies: Iterable[Study]) -> None:
    """Refuse studies of other models, or of this model with other values, before anything is calculated.

    Raises
    ------
    UsageError
        With all of them, and what differs.
    """
    found = [text for one in studies if (text := _refusal(model, one))]
    if found:
        raise UsageError(
            "\n".join([*found, "a report shows only studies of its own model; run them again with this model"])
        )


def _refusal(model: Drivetrain, study: Study) -> str:
    own = study.model
    if model.configuration and model.configuration in own.configurations:
        own = own.configured(model.configuration)
    differing = _differing(model.with_entries_named(study.space.names), own)
    if not differing:
        return ""
    if own.name != model.name:
        return f"the study {study.title} is of {own.name}, and the report of {model.name}"
    what = comma_list(differing, MOST_DIFFERENCES)
    return f"the study {study.title} is of another {own.title} than the report of {model.title}: they differ in {what}"


def _differing(one: Drivetrain, other: Drivetrain) -> list[str]:
    """Texts with the names of entries that differ between two models, with their values where these are short."""
    mine, others = _data(one), _data(other)
    found = []
    for key in dict.fromkeys((*mine, *others)):
        here, there = mine.get(key), others.get(key)
        if isinstance(here, dict) and isinstance(there, dict):
            names = [name for name in dict.fromkeys((*here, *there)) if here.get(name) != there.get(name)]
            found += [f"{key}.{name}{_values(there.get(name), here.get(name))}" for name in names]
        elif here != there:
            found.append(key)
    return found


def _data(model: Drivetrain) -> dict[str, Any]:
    data = json.loads(json.dumps(model.definition.flat_data(), default=str))
    return {key: value for key, value in data.items() if key not in IGNORED_ENTRIES}


def _values(study: Any, report: Any) -> str:
    """Text with the values of a parameter in the study and in the report; empty where it has no single value."""
    shown = [one.get("value") if isinstance(one, dict) else one for one in (study, report)]
    texts = ["missing" if one is None else one for one in shown]
    return "" if any(isinstance(one, dict | list) or one == "" for one in texts) or texts == ["missing"] * 2 else (
        f" ({texts[0]} in the study, {texts[1]} in the report)"
    )  # fmt: skip
