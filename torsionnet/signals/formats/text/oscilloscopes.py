"""Headings of the text files of oscilloscopes that tell first time and interval of the samples, but list no times.

Rigol DS and MSO1000Z: ``X,CH1,Start,Increment`` above ``Sequence,Volt,-1.2E-02,1E-04``; MSO5000: ``CH1(V),t0 = -25s,
tInc = 2e-06s``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.base.delimited.dialect import Dialect
from torsionnet.base.delimited.headings import Headings

START, INCREMENT, COUNTED = "start", "increment", "sequence"
"""Headings above the first time and the interval in s, and the unit of a column that counts samples, in lower case."""
_STATED = re.compile(r"\s*(?P<name>t0|tinc)\s*=\s*(?P<number>[+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*s?\s*", re.IGNORECASE)
_CHANNEL = re.compile(r"\s*(?P<name>[^()]*[^()\s])\s*(?:\((?P<unit>[^()]*)\))?\s*")


@dataclass(frozen=True)
class ScopeHeading:
    """Names and units of the columns of an oscilloscope's file, with the clock that its heading tells.

    ``start`` and ``interval`` are in s; the first ``skipped`` columns only count samples.
    """

    headings: Headings
    start: float
    interval: float
    skipped: int = 0


def scope_heading(dialect: Dialect, above: Sequence[str], width: int) -> ScopeHeading | None:
    """Heading of an oscilloscope's file in the lines above its numbers, None where there is none of these kinds.

    >>> lines = ["X,CH1,Start,Increment,", "Sequence,Volt,-1.2E-02,1.0E-04,"]
    >>> found = scope_heading(Dialect(","), lines, 3)
    >>> found.headings.names, found.headings.units, found.start, found.interval
    (('X', 'CH1', ''), ('Sequence', 'Volt', ''), -0.012, 0.0001)
    """
    if len(above) > 1:
        names, second = (dialect.cells(line) for line in above[-2:])
        places = [at for word in (START, INCREMENT) for at, name in enumerate(names) if name.casefold() == word]
        if len(places) == 2 and max(places) < len(second) and all(dialect.is_number(second[at]) for at in places):
            start, interval = (dialect.number(second[at]) for at in places)
            count = min(places)
            headings = _padded(names[:count], second[:count], width, 2)
            return ScopeHeading(headings, start, interval, int(second[0].casefold() == COUNTED))
    cells = re.split(r"[,;\t]", above[-1].strip()) if above else []
    stated = {match["name"].casefold(): float(match["number"]) for match in map(_STATED.fullmatch, cells) if match}
    if stated.keys() < {"t0", "tinc"} or not stated:
        return None
    channels = [match for cell in cells if not _STATED.fullmatch(cell) and (match := _CHANNEL.fullmatch(cell))]
    headings = _padded([match["name"] for match in channels], [match["unit"] or "" for match in channels], width, 1)
    return ScopeHeading(headings, stated["t0"], stated["tinc"])


def _padded(names: Sequence[str], units: Sequence[str], width: int, lines: int) -> Headings:
    """Headings of as many columns as there are, those without a name at the end being empty."""
    rest = [""] * width
    note = "names, start and interval from the heading of an oscilloscope"
    return Headings(tuple([*names, *rest][:width]), tuple([*units, *rest][:width]), lines, (note,))
