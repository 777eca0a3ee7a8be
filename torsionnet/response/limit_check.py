"""What a check of limits found: worst speed, utilisation and verdict of every criterion, speeds to be barred."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.core.units import RPM
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import FloatArray
from torsionnet.response.speed_spans import SpeedSpan, joined_spans
from torsionnet.response.table import Column, Table

PASS, BARRED, FAIL, OPEN = "pass", "barred range", "fail", "not judged"
"""Verdicts: holds at every speed; holds outside of speeds that are barred; does not hold; data are missing."""


@dataclass(frozen=True)
class RuleText:
    """Where a rule comes from, what it says as a formula, and what it leaves out."""

    source: str
    formula: str
    not_covered: str


@dataclass(frozen=True, eq=False, kw_only=True)
class LimitVerdict:
    """One criterion of one limit over speed.

    Attributes
    ----------
    limit : str
        Its name in the model.
    of : str
        Element, node or output it is about.
    criterion : str
        The symbol of the value allowed, as tau_C.
    quantity : str
        What is compared with it.
    unit : str
        SI.
    values, allowed : (n_speeds,) arrays
        NaN in ``allowed`` at speeds that the rule does not cover; both empty where nothing could be judged.
    verdict : {"pass", "barred range", "fail", "not judged"}
    text : RuleText
    barred : tuple of SpeedSpan
        Speeds to be barred so that the limit holds everywhere else.
    remarks : tuple of str
    orders : (n_speeds, n_lines) array, optional
        Amplitudes of the orders that make ``values``.
    """

    limit: str
    of: str
    criterion: str
    quantity: str
    unit: str
    values: FloatArray
    allowed: FloatArray
    verdict: str
    text: RuleText
    barred: tuple[SpeedSpan, ...] = ()
    remarks: tuple[str, ...] = ()
    orders: FloatArray | None = None

    @property
    def utilisation(self) -> FloatArray:
        """Value over value allowed, (n_speeds,); NaN where nothing is allowed or covered."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(np.isfinite(self.allowed), self.values / self.allowed, np.nan))

    @property
    def worst(self) -> int | None:
        """Place of the speed with the largest utilisation."""
        found = self.utilisation
        return None if not np.isfinite(found).any() else int(np.nanargmax(found))


@dataclass(frozen=True, eq=False)
class LimitCheck:
    """Verdicts on all limits of a model in one condition.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Of the reference shaft, rad/s.
    reference : str
        Its node.
    verdicts : tuple of LimitVerdict
    lines : tuple of str
        Names of the orders in ``LimitVerdict.orders``.
    title, configuration : str
    misfiring : bool
        Whether a cylinder misfires in this condition.
    """

    speeds: FloatArray
    reference: str
    verdicts: tuple[LimitVerdict, ...]
    lines: tuple[str, ...] = ()
    title: str = ""
    configuration: str = ""
    misfiring: bool = False
    notes: tuple[str, ...] = field(default=())

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft, r/min."""
        return np.asarray(self.speeds * RPM)

    @property
    def verdict(self) -> str:
        """The gravest of all verdicts."""
        return max((one.verdict for one in self.verdicts), key=(PASS, BARRED, OPEN, FAIL).index, default=PASS)

    @property
    def barred(self) -> tuple[SpeedSpan, ...]:
        """Speeds that any limit wants barred, joined where they overlap."""
        return joined_spans([span for one in self.verdicts for span in one.barred])

    @property
    def conclusion(self) -> str:
        """What follows from all verdicts, in a sentence."""
        failed = list(dict.fromkeys(one.limit for one in self.verdicts if one.verdict == FAIL))
        unjudged = list(dict.fromkeys(one.limit for one in self.verdicts if one.verdict == OPEN))
        barred = ", ".join(map(str, self.barred))
        parts = [f"{', '.join(failed)} {'do' if len(failed) > 1 else 'does'} not hold"] if failed else []
        if any(one.verdict == BARRED for one in self.verdicts) and not failed:
            parts.append(f"limits hold with {barred} of {self.reference} barred")
        elif barred:
            parts.append(f"to be barred: {barred} of {self.reference}")
        parts += [f"{', '.join(unjudged)} not judged"] if unjudged else []
        examined = f"{self.rpm[0]:g} to {self.rpm[-1]:g} rpm of {self.reference}"
        return "; ".join(parts) or f"all limits hold at the speeds examined, {examined}"

    def of(self, limit: str, criterion: str | None = None) -> LimitVerdict:
        """The verdict on a limit, on one of its criteria where there are several.

        Raises
        ------
        UsageError
            There is none, or there are several and no criterion is named.
        """
        found = [one for one in self.verdicts if one.limit == limit and criterion in (None, one.criterion)]
        if len(found) == 1:
            return found[0]
        known = [f"{one.limit} {one.criterion}" for one in self.verdicts]
        asked = f"{limit} {criterion}" if criterion else limit
        what = f"say which criterion of {limit}" if found else f'no limit "{asked}"{did_you_mean(asked, known)}'
        raise UsageError(f"{what}; there are {', '.join(known)}")

    def table(self, conventions: Conventions = SI) -> Table:
        """One row for every criterion, at its worst speed; what it rests on below."""
        columns = (
            Column("limit"),
            Column("of"),
            Column("criterion"),
            Column("worst speed", "rpm", digits=5),
            Column("value", digits=5),
            Column("allowed", digits=5),
            Column("unit"),
            Column("utilisation", digits=4),
            Column("verdict"),
            Column("to be barred"),
        )
        rows = tuple(self._row(one, conventions) for one in self.verdicts)
        notes = [f"speeds of {self.reference}, {self.rpm[0]:g} to {self.rpm[-1]:g} rpm", *self.notes]
        for one in self.verdicts:
            notes += [f"{one.limit}, {one.criterion}: {remark}" for remark in one.remarks]
        for text, names in self.texts().items():
            notes += [f"{', '.join(names)}: {text.source}", f"  {text.formula}", f"  not covered: {text.not_covered}"]
        return Table(f"{self.title}: limits", columns, rows, tuple(dict.fromkeys(notes)))

    def texts(self) -> dict[RuleText, list[str]]:
        """Names of the limits by the text of their rule."""
        found: dict[RuleText, list[str]] = {}
        for one in self.verdicts:
            names = found.setdefault(one.text, [])
            names += [] if one.limit in names else [one.limit]
        return found

    def _row(self, one: LimitVerdict, conventions: Conventions) -> tuple[object, ...]:
        barred = ", ".join(map(str, one.barred)) or None
        at = one.worst
        if at is None:
            return (one.limit, one.of, one.criterion, None, None, None, None, None, one.verdict, barred)
        scale = conventions.scale(one.unit)
        sizes = (float(one.values[at]) * scale, float(one.allowed[at]) * scale)
        numbers = (float(self.rpm[at]), *sizes, conventions.unit(one.unit), float(one.utilisation[at]))
        return (one.limit, one.of, one.criterion, *numbers, one.verdict, barred)

    def long_table(self) -> Table:
        """Value and value allowed at every speed, SI."""
        columns = (
            Column("limit"), Column("of"), Column("criterion"), Column("speed", "rpm"), Column("value"),
            Column("allowed"), Column("unit"), Column("utilisation"),
        )  # fmt: skip
        rows = []
        for one in self.verdicts:
            cells = (self.rpm.tolist(), one.values.tolist(), one.allowed.tolist(), one.utilisation.tolist())
            if len(one.values):
                rows += [
                    (one.limit, one.of, one.criterion, rpm, value, allowed, one.unit, share)
                    for rpm, value, allowed, share in zip(*cells, strict=True)
                ]
        return Table(f"{self.title}: limits over speed", columns, tuple(rows), (f"speeds of {self.reference}",))
