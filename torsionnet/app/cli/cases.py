"""Drivetrains that a command calculates, one model in the configurations chosen, with parameters set."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

from torsionnet.app.cli.command import Command
from torsionnet.app.cli.options import SETTINGS, WrongUsage, argument, load_model, option
from torsionnet.app.cli.terminal import message, print_faults
from torsionnet.base.errors import comma_list

if TYPE_CHECKING:
    from torsionnet.base.errors import Fault
    from torsionnet.base.table import Table
    from torsionnet.drivetrain import Drivetrain

Result = TypeVar("Result")
Entry = TypeVar("Entry")
CONFIGURATIONS_NAMED = 12
"""Number of configurations that a note names before it ends in "...", about two lines of a terminal."""


@dataclass(frozen=True)
class ConfiguredCase:
    """A drivetrain and the name of its configuration, empty for the model as written."""

    configuration: str
    drivetrain: Drivetrain

    def data(self, result: object, without: Collection[str] = ()) -> dict[str, Any]:
        """JSON data of a result of the case, without the fields with these names, with its configuration."""
        from torsionnet.base.result_rows import to_json

        return with_configuration(to_json(result, without), self.configuration)


def with_configuration(entries: Mapping[str, Entry], configuration: Entry) -> dict[str, Entry]:
    """Entries of a result by key, with that of its configuration behind the title, or first where it has none.

    >>> list(with_configuration({"title": "rig", "modes": ()}, "V"))
    ['title', 'configuration', 'modes']
    """
    title = {key: entries[key] for key in ("title",) if key in entries}
    return {**title, "configuration": configuration, **entries}


class ModelCommand(Command):
    """Arguments of a command that calculates a model in some of its configurations."""

    model: str = argument("MODEL")
    configurations: tuple[str, ...] = option(
        "--configuration",
        "-c",
        metavar="NAME",
        help='A configuration ("V"; "gear=V,clutch=open" on several axes), or "all". Repeatable.',
    )
    settings: tuple[tuple[str, str], ...] = SETTINGS

    def cases(self) -> list[ConfiguredCase]:
        """Drivetrain in every configuration that the command line asks for, with parameters set.

        Warnings and notes about the model go to stderr.
        """
        from torsionnet.app.cli.terminal import progress

        with progress("reading the model", None):
            rig = load_model(self.model)
            found = list(rig.check())
        names = _names(rig, self.configurations)
        cases = []
        for name in names:
            changed = rig.configured(name, **dict(self.settings)) if name or self.settings else rig
            known = {fault.message for fault in found}
            found += [_of(fault, changed) for fault in changed.check() if fault.message not in known]
            cases.append(ConfiguredCase(changed.configuration, changed))
        print_faults(found)
        return cases

    def each(
        self, what: str, cases: Sequence[ConfiguredCase], answer: Callable[[ConfiguredCase], Result]
    ) -> list[Result]:
        """Results of a function for each case, in their order, while a terminal shows what is calculated for which."""
        from torsionnet.app.cli.terminal import stages

        total, found = (len(cases) if len(cases) > 1 else None), []
        with stages() as show:
            for done, case in enumerate(cases):
                show(what, done, total, f"{what} {case.configuration}".strip())
                found.append(answer(case))
        return found

    def require_one(self, why: str) -> None:
        """Raise an error with the message given where several configurations are asked for."""
        from torsionnet.model.configurations import ALL_CONFIGURATIONS

        if len(self.configurations) > 1 or ALL_CONFIGURATIONS in self.configurations:
            raise WrongUsage(why, kind="wrong-count")

    def combined_table(self, cases: Sequence[ConfiguredCase], tables: Sequence[Table]) -> Table:
        """Table with the rows of all drivetrains, and the configuration in the first column if any was named.

        Equal notes stand once; a note that is not on all cases begins with the names of its configurations.
        """
        from torsionnet.base.equal_remarks import configurations_in_words, grouped_remarks
        from torsionnet.base.table import Column

        first = tables[0]
        if not self.configurations:
            return first
        pairs = list(zip(cases, tables, strict=True))
        rows = tuple((case.configuration, *row) for case, table in pairs for row in table.rows)
        known = list(dict.fromkeys(case.configuration for case in cases))
        said = (("", case.configuration, note) for case, table in pairs for note in table.notes)
        notes = tuple(
            note if len(names) == len(known) else f"{configurations_in_words(names, known)}: {note}"
            for _, names, note in grouped_remarks(said)
        )
        title = cases[0].drivetrain.name if len(cases) > 1 else first.title
        columns = (Column("configuration"), *first.columns)
        return replace(first, title=title, columns=columns, rows=rows, notes=notes)


def _of(fault: Fault, changed: Drivetrain) -> Fault:
    return replace(fault, configuration=fault.configuration or changed.configuration)


def _names(rig: Drivetrain, configurations: Sequence[str]) -> list[str]:
    from torsionnet.model.configurations import ALL_CONFIGURATIONS

    available = rig.configurations
    if not configurations:
        if available:
            names = comma_list(available, CONFIGURATIONS_NAMED, ", ...")
            message("note", f"parameters as written; configurations: {names} (-c NAME, or -c all)")
        return [""]
    if ALL_CONFIGURATIONS in configurations and ALL_CONFIGURATIONS not in available:
        if not available:
            message("note", "the model has no configurations")
        return list(available) or [""]
    return list(dict.fromkeys(configurations))
