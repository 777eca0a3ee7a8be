"""Conclusion on the limits of a model from checks of its configurations; no pass while one was not examined."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, ClassVar

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.machinery.verdicts.limit_check import (
    ALL_EXAMINED_HOLD,
    ALL_HOLD,
    LimitCheck,
    band_findings,
    by_range,
    starts_findings,
    starts_words,
    unexamined_sentence,
)
from torsionnet.machinery.verdicts.limit_verdict import (
    FAIL,
    INCOMPLETE,
    OPEN,
    PASS,
    VERDICT,
    LimitVerdict,
    gravest,
    listed_names,
)
from torsionnet.machinery.verdicts.measured_range import MeasuredRange
from torsionnet.machinery.verdicts.operating_instructions import (
    Instruction,
    instruction_table,
    operating_instructions,
)
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, in_condition, joined_spans, rpm_spans
from torsionnet.model.condition_titles import ConditionTitles

MOST_RESTRICTIONS = 6
"""Largest number of findings on restricted speeds; further ones are in the operating instructions."""


@dataclass(frozen=True, eq=False)
class WorstLimit:
    """Criterion of a limit at its largest utilisation in all configurations, and its gravest verdict in any of them."""

    check: LimitCheck
    verdict: LimitVerdict
    gravest: str

    @property
    def rpm(self) -> float | None:
        """Speed of the reference shaft in r/min at which a limit is used most, None if it was not judged."""
        return self.verdict.worst_rpm

    @property
    def utilisation(self) -> float | None:
        """Largest ratio of value to allowed value of a limit over configurations and speeds, None if not judged."""
        return self.verdict.worst_utilisation


RATED_NOT_REACHED = "rated speed, {speed:.6g} rpm of {shaft}, is permitted in no condition examined"
"""Finding where limits permit rated speed nowhere."""


@dataclass(frozen=True, eq=False)
class LimitConclusion:
    """Overall verdict on the limits of a model, with barred speeds and worst values, from checks of its configurations.

    Attributes
    ----------
    checks : tuple of LimitCheck
        Checks of one model, one for each configuration that was examined.
    titles : ConditionTitles, optional
        Titles of the configurations in sentences; default: their names.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ship = tn.load("two_stroke_ship")
    >>> conclusion = LimitConclusion((ship.configured("normal").check_limits("tail"),))
    >>> conclusion.verdict, conclusion.not_examined
    ('incomplete', ('misfire', 'misfire_2'))
    """

    SHOWN: ClassVar = ("verdict", "sentence", "not_examined", "left_out", "barred_rpm", "instructions")

    checks: tuple[LimitCheck, ...]
    titles: ConditionTitles | None = None

    def __post_init__(self) -> None:
        if not self.checks:
            raise UsageError(
                "a conclusion on limits needs at least one check of limits; there is none", kind="missing-entry"
            )

    @property
    def configurations(self) -> tuple[str, ...]:
        """Names of all configurations of the model, examined or not."""
        return self.checks[0].configurations

    @property
    def not_examined(self) -> tuple[str, ...]:
        """Names of the configurations of the model for which there is no check of limits."""
        return tuple(name for name in self.configurations if all(name in check.others for check in self.checks))

    @property
    def left_out(self) -> tuple[str, ...]:
        """Texts on the limits and excitations that the checks of limits left out."""
        return tuple(dict.fromkeys(words for check in self.checks for words in check.left_out))

    @property
    def verdict(self) -> Annotated[str, Out(schema=VERDICT)]:
        """Name of the gravest of all verdicts on the limits of a model in the configurations examined.

        "incomplete" instead of one that permits operation if not all was examined.
        """
        verdicts = [judged.verdict for _, judged in self._verdicts()]
        verdicts += [check.run_up.verdict for check in self.checks if check.run_up]
        return gravest([*verdicts, *([INCOMPLETE] if self.not_examined or self.left_out else [])])

    @property
    def barred(self) -> tuple[SpeedSpan, ...]:
        """Speed ranges in rad/s to be barred in any configuration, joined where they overlap."""
        return joined_spans([span for check in self.checks for span in check.barred])

    @property
    def barred_rpm(self) -> tuple[tuple[float, float], ...]:
        """Pairs of lowest and highest speed in rpm of the ranges to be barred in any configuration."""
        return rpm_spans(self.barred)

    @cached_property
    def instructions(self) -> tuple[Instruction, ...]:
        """Instructions to the crew on the speeds that limits restrict in any configuration."""
        return operating_instructions(self.checks)

    def instruction_table(self, conventions: Conventions = SI) -> Table:
        """Table of the operating instructions, with notes on any other restriction."""
        return instruction_table(self.checks, conventions)

    def worst(self) -> tuple[WorstLimit, ...]:
        """Criteria of all limits, each in the configuration and at the speed of largest utilisation, most used first.

        Examples
        --------
        >>> import torsionnet as tn
        >>> ship = tn.load("two_stroke_ship")
        >>> (worst,) = LimitConclusion((ship.configured("misfire").check_limits("intermediate"),)).worst()[:1]
        >>> worst.verdict.criterion, worst.gravest, round(worst.rpm), round(worst.utilisation, 2)
        ('tau_C', 'reduced speed', 104, 1.1)
        """
        by_criterion: dict[tuple[str, str], list[tuple[LimitCheck, LimitVerdict]]] = {}
        for check, verdict in self._verdicts():
            by_criterion.setdefault((verdict.limit, verdict.criterion), []).append((check, verdict))
        worst = [
            WorstLimit(*max(those, key=lambda pair: _use(pair[1])), gravest(verdict.verdict for _, verdict in those))
            for those in by_criterion.values()
        ]
        return tuple(sorted(worst, key=lambda limit: -(math.inf if limit.utilisation is None else limit.utilisation)))

    def worst_table(self, conventions: Conventions = SI) -> Table:
        """Table of limits with a row per criterion, in the configuration and at the speed of largest utilisation."""
        worst = self.worst()
        tables = [replace(limit.check, verdicts=(limit.verdict,)).table(conventions) for limit in worst]
        rows = [(limit.check.configuration, *table.rows[0]) for limit, table in zip(worst, tables, strict=True)]
        return Table("worst of all configurations", (Column("configuration"), *tables[0].columns), tuple(rows))

    @property
    def sentence(self) -> Annotated[str, Out(json="conclusion")]:
        """Sentence that concludes from all checks of limits, with what was not examined."""
        return joined("; ", self.findings)

    @property
    def findings(self) -> tuple[str, ...]:
        """Texts that conclude from all checks of limits, one for what was not examined and one for each finding.

        What restricts the speeds is said of each condition by itself, as far as conditions do not have the same.
        """
        if len(self.checks) == 1 and self.titles is None:
            return self.checks[0].findings
        examined = [self._titled(check.configuration) for check in self.checks]
        missing = unexamined_sentence(
            [self._titled(name) for name in self.not_examined], [self._titled(name) for name in self.configurations],
            examined,
        )  # fmt: skip
        starts = starts_findings(self.checks, self._where)
        return (
            *missing,
            *self.left_out,
            *starts,
            *band_findings(self.checks, self._where),
            *self._limit_findings(),
        )

    @property
    def starts(self) -> str:
        """Words on how far starts were examined, as they stand beside the verdict."""
        return starts_words(self.checks)

    def _verdicts(self) -> Iterator[tuple[LimitCheck, LimitVerdict]]:
        """Yield pairs of check and verdict, none on a switched-off element whose limit another check judges."""
        judged = {verdict.limit for check in self.checks for verdict in check.verdicts if verdict.verdict != OPEN}
        for check in self.checks:
            yield from (
                (check, verdict) for verdict in check.verdicts if not (verdict.absent and verdict.limit in judged)
            )

    def _limit_findings(self) -> list[str]:
        failed, unjudged, restricted = self._of(FAIL), self._of(OPEN), self._restrictions()
        parts = [*self._rated_not_reached()]
        parts += [self._not_kept(name, where) for name, where in failed.items()]
        if restricted:
            parts += restricted
        elif not failed and not unjudged:
            parts += self._all_hold()
        return [
            *parts,
            *(phrase("{limit} not judged{where}", limit=name, where=where) for name, where in unjudged.items()),
        ]

    def _rated_not_reached(self) -> Iterator[str]:
        """Sentence that no condition examined permits rated speed; nothing where one does, or none examines it."""
        reach = [check for check in self.checks if check.rated and check.speeds[0] <= check.rated <= check.speeds[-1]]
        if reach and not any(check.permits(check.rated or 0.0) for check in reach):
            rated = (reach[0].rated or 0.0) * RPM
            yield phrase(RATED_NOT_REACHED, speed=rated, shaft=self._shaft)

    def _not_kept(self, name: str, where: str) -> str:
        count = len(self.configurations)
        if count > 1 and where == self._where(list(self.configurations)):
            return phrase("{limit} holds in none of {count} configurations", limit=name, count=count)
        return phrase("{limit} does not hold{where}", limit=name, where=where)

    def _all_hold(self) -> Iterator[str]:
        template = ALL_EXAMINED_HOLD if self.left_out else ALL_HOLD
        for (low, high), checks in by_range(self.checks).items():
            where = self._where([check.configuration for check in checks])
            yield phrase(template, where=where, low=low, high=high, shaft=self._shaft)

    @property
    def _shaft(self) -> str:
        return self.checks[0].reference

    def _of(self, verdict: str) -> dict[str, str]:
        """Text that names the configurations in which a limit has the given verdict, by name of the limit."""
        configurations: dict[str, list[str]] = {}
        for check, judged in self._verdicts():
            if judged.verdict == verdict:
                configurations.setdefault(judged.limit, []).append(check.configuration)
        return {name: self._where(list(dict.fromkeys(names))) for name, names in configurations.items()}

    def _restrictions(self) -> list[str]:
        """Texts on the speeds in rpm that are not permitted, for each condition, or several that have the same."""
        alike: dict[tuple[str, bool, bool], list[str]] = {}
        for check in self.checks:
            reduced = check.highest is not None
            holds = not reduced and check.verdict != FAIL
            if check.restriction:
                alike.setdefault((check.restriction, holds, reduced), []).append(check.configuration)
        parts: list[str] = []
        for (restriction, holds, reduced), names in [*alike.items()][:MOST_RESTRICTIONS]:
            if holds:
                template = "limits hold with {speeds} barred{where}"
                parts.append(phrase(template, speeds=restriction, where=self._where(names)))
            else:
                text = restriction if reduced else phrase("to be barred: {speeds}", speeds=restriction)
                parts.append(in_condition(text, self._named(names)))
        rest = sum(map(len, [*alike.values()][MOST_RESTRICTIONS:]))
        if rest:
            parts.append(phrase("{count} further conditions are restricted by the operating instructions", count=rest))
        calm = [check.configuration for check in self.checks if check.verdict == PASS]
        if calm and parts and not any(holds for _, holds, _ in alike):
            return [phrase("limits hold{where}", where=self._where(calm)), *parts]
        return parts

    def _titled(self, configuration: str) -> str:
        return self.titles.of(configuration) if self.titles else configuration

    def _where(self, names: Sequence[str]) -> str:
        named = self._named(names)
        return phrase(" in {names}", names=named) if named else ""

    def _named(self, names: Sequence[str]) -> str:
        """Text that names configurations; empty for the model as written."""
        named = [name for name in names if name]
        if len(self.configurations) > 1 and len(named) == len(self.configurations):
            return phrase("all {count} configurations", count=len(named))
        return self.titles.several(named, self.configurations) if self.titles and named else listed_names(named)


def _use(verdict: LimitVerdict) -> float:
    if verdict.worst_utilisation is None:
        # Nothing is allowed, which is worse than any utilisation, or nothing was judged.
        return math.inf if verdict.verdict == FAIL else -1.0
    return verdict.worst_utilisation


@dataclass(frozen=True, eq=False, repr=False)
class ConcludedCheck(LimitCheck):
    """Check of the limits in one configuration, with the conclusion from all of them and a test beside it.

    Attributes
    ----------
    overall : LimitConclusion
    measured : tuple of MeasuredRange, optional
        Half ranges of a test in this configuration.
    """

    SHOWN: ClassVar = (
        "title", "configuration", "reference", "misfiring", "verdict", "overall", "barred_rpm", "rpm", "verdicts",
        "run_up", "notes", "measured",
    )  # fmt: skip

    overall: LimitConclusion = field(kw_only=True)
    measured: Annotated[tuple[MeasuredRange, ...] | None, Out(optional=True)] = None
