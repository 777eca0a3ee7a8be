"""The drivetrains a command is about: one model in the configurations chosen, with the parameters set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from torsionnet.cli.models import load_model
from torsionnet.cli.terminal import message, tell
from torsionnet.model.configurations import EVERY

if TYPE_CHECKING:
    from torsionnet.core.errors import Fault
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.response.table import Table


@dataclass(frozen=True)
class ConfiguredCase:
    """A drivetrain and the name of its configuration, empty for the model as written."""

    configuration: str
    drivetrain: Drivetrain


def load_cases(model: str, configurations: Sequence[str], settings: Sequence[tuple[str, str]]) -> list[ConfiguredCase]:
    """The model in every configuration asked for; what is worth knowing about it goes to stderr."""
    rig = load_model(model)
    found = list(rig.check())
    names = _names(rig, configurations)
    cases = []
    for name in names:
        changed = rig.configured(name, **dict(settings)) if name or settings else rig
        known = {fault.message for fault in found}
        found += [_of(fault, changed) for fault in changed.check() if fault.message not in known]
        cases.append(ConfiguredCase(changed.configuration, changed))
    tell(found)
    return cases


def _of(fault: Fault, changed: Drivetrain) -> Fault:
    return replace(fault, configuration=fault.configuration or changed.configuration)


def _names(rig: Drivetrain, configurations: Sequence[str]) -> list[str]:
    available = rig.configurations
    if not configurations:
        if available:
            message("note", f"parameters as written; configurations: {_listed(available)} (-c NAME, or -c all)")
        return [""]
    if EVERY in configurations and EVERY not in available:
        if not available:
            message("note", "the model has no configurations")
        return list(available) or [""]
    return list(dict.fromkeys(configurations))


def _listed(names: Sequence[str], most: int = 12) -> str:
    return ", ".join(names[:most]) + (", ..." if len(names) > most else "")


def joined(cases: Sequence[ConfiguredCase], tables: Sequence[Table], *, named: bool) -> Table:
    """One table out of one per case, with the configuration in the first column if ``named``."""
    from torsionnet.response.table import Column

    first = tables[0]
    if not named:
        return first
    rows = tuple((case.configuration, *row) for case, table in zip(cases, tables, strict=True) for row in table.rows)
    shared = set(first.notes).intersection(*(table.notes for table in tables))
    notes = [
        note if note in shared else f"{case.configuration}: {note}"
        for case, table in zip(cases, tables, strict=True)
        for note in table.notes
    ]
    title = cases[0].drivetrain.name if len(cases) > 1 else first.title
    return replace(
        first,
        title=title,
        columns=(Column("configuration"), *first.columns),
        rows=rows,
        notes=tuple(dict.fromkeys(notes)),
    )


def file_of(file: str, case: ConfiguredCase, cases: Sequence[ConfiguredCase]) -> str:
    """The file itself for a single case, else one per case: ``shapes.png`` -> ``shapes_gear_V_clutch_open.png``."""
    if len(cases) == 1:
        return file
    path = Path(file)
    suffix = case.configuration.replace("=", "_").replace(",", "_")
    return str(path.with_name(f"{path.stem}_{suffix}{path.suffix}"))
