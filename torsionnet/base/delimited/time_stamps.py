"""Columns of time stamps, with or without a date, as seconds from the first stamp."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.delimited.stamp_formats import (
    NANOSECONDS_PER_DAY,
    NANOSECONDS_PER_SECOND,
    STAMP_PATTERN,
    day_month_order,
    invalid_date,
    nanoseconds,
    ordinal,
    stamp_format,
    written_date,
    zone_offset,
)

FloatArray = NDArray[np.float64]


@dataclass
class StampReader:
    """Reader of a column of time stamps, which all have one format; ``first`` is the first of them."""

    first: str = ""
    _form: tuple[str, ...] = ()
    _mark: str = ""
    _begun: bool = False
    _begin: int = 0
    _last: int = 0
    _days: int = 0
    _first_date: str = ""
    _dates: dict[str, int] = field(default_factory=dict)

    def seconds(self, texts: Sequence[str]) -> tuple[FloatArray, list[tuple[int, str]]]:
        """Seconds since the first stamp, shape (n_texts,), NaN for empty cells, and (index, message) of faults."""
        if texts and not self.first and (begins := STAMP_PATTERN.fullmatch(texts[0])):
            self._unlike(texts[0], begins)
            self._learn_date(written_date(begins), texts[:1])
        quick = self._alike(texts)
        faults: list[tuple[int, str]] = []
        if quick is not None:
            clocks, known = quick, np.ones(len(texts), dtype=bool)
        else:
            clocks, known = np.zeros(len(texts), dtype=np.int64), np.zeros(len(texts), dtype=bool)
            matches = [STAMP_PATTERN.fullmatch(text) for text in texts]
            for at, (text, found) in enumerate(zip(texts, matches, strict=True)):
                wrong = self._unlike(text, found) if text else ""
                if wrong:
                    faults.append((at, wrong))
                elif found:
                    unknown = written_date(found) not in self._dates and self._learn_date(
                        written_date(found), texts[at:]
                    )
                    if unknown:  # no date below it can be counted either
                        faults.append((at, unknown))
                        break
                    clocks[at], known[at] = (
                        nanoseconds(found) + self._dates.get(written_date(found), 0) * NANOSECONDS_PER_DAY,
                        True,
                    )
        if faults:
            return np.full(len(texts), np.nan), faults
        return self._counted(clocks, known), []

    def _counted(self, clocks: NDArray[np.int64], known: NDArray[np.bool_]) -> FloatArray:
        values = clocks[known]
        if self._form and not self._form[0]:  # a clock without a date passes midnight
            before = np.concatenate([[self._last] if self._begun else values[:1], values[:-1]])[: len(values)]
            days = self._days + np.cumsum(values - before < -NANOSECONDS_PER_DAY // 2)
            self._last = int(values[-1]) if len(values) else self._last
            self._days = int(days[-1]) if len(days) else self._days
            values = values + days * NANOSECONDS_PER_DAY
        if len(values) and not self._begun:
            self._begin, self._begun = int(values[0]), True
        found = np.full(len(clocks), np.nan)
        found[known] = (values - self._begin) / NANOSECONDS_PER_SECOND
        return found

    def _unlike(self, text: str, found: re.Match[str] | None) -> str:
        """Message about a time stamp whose format differs from that of the first stamp."""
        if found is None:
            return f'"{text}" is not a time stamp; write it like "{self.first or "10:12:13.001"}"'
        form, mark = stamp_format(found), found["mark"] or ""
        if not self.first:
            self.first, self._form = text, form
        self._mark = self._mark or mark
        if form != self._form or (mark and mark != self._mark):
            return f'"{text}" is written otherwise than the time stamps above it, like "{self.first}"; write all alike'
        return ""

    def _learn_date(self, text: str, left: Sequence[str]) -> str:
        """Message about the date of a time stamp that cannot be read.

        A good date is stored as days from the first date.
        """
        if not text:
            return ""
        order = self._form[0]
        if not self._first_date:
            if order != "either" and ordinal(text, order) is None:
                return invalid_date(text)
            self._first_date, self._dates[text] = text, 0
            return ""
        if order == "either":
            later = {written_date(found) for found in map(STAMP_PATTERN.fullmatch, left) if found}
            orders = {order for one in (*self._dates, *later) if (order := day_month_order(one))}
            if len(orders) != 1:
                what = "whether day or month comes first is not said" if not orders else "day and month change places"
                return f"the date changes from {self._first_date} to {text}: {what}; write dates as 2024-05-03"
            (order,) = orders
        days, begun = ordinal(text, order), ordinal(self._first_date, order)
        if days is None or begun is None:
            return invalid_date(text)
        self._dates[text] = days - begun
        return ""

    def _alike(self, texts: Sequence[str]) -> NDArray[np.int64] | None:
        """Nanoseconds, shape (n_texts,), of stamps that differ only in the digits of their times.

        None for all others.
        """
        found = STAMP_PATTERN.fullmatch(texts[0]) if texts else None
        date_text = written_date(found) if found else ""
        if found is None or found["half"] or (date_text and date_text not in self._dates):
            return None
        if stamp_format(found) != self._form or (found["mark"] or self._mark) != self._mark or not texts[0].isascii():
            return None
        try:
            rows = np.array(texts, dtype=f"S{len(texts[0]) + 1}")
        except UnicodeEncodeError:
            return None
        signs = rows.view(np.uint8).reshape(len(texts), -1)
        template, fixed = signs[0], np.ones(signs.shape[1], dtype=bool)
        groups = [found.span(name) for name in ("hours", "minutes", "seconds", "part")]
        for begin, end in groups:
            fixed[begin:end] = False
        digits = signs[:, ~fixed]
        if (signs[:, fixed] != template[fixed]).any() or (digits < 48).any() or (digits > 57).any():
            return None
        hours, minutes, seconds, part = (_whole(signs[:, begin:end]) for begin, end in groups)
        if (hours > 23).any() or (minutes > 59).any() or (seconds > 60).any():
            return None
        length = groups[3][1] - groups[3][0]
        if length > 9:
            return None
        whole = (hours * 60 + minutes) * 60 + seconds - zone_offset(found["zone"])
        nano = whole * NANOSECONDS_PER_SECOND + part * 10 ** (9 - length)
        return np.asarray(nano + self._dates.get(date_text, 0) * NANOSECONDS_PER_DAY, dtype=np.int64)


def _whole(digits: NDArray[np.uint8]) -> NDArray[np.int64]:
    powers = 10 ** np.arange(digits.shape[1] - 1, -1, -1, dtype=np.int64)
    return np.asarray((digits.astype(np.int64) - 48) @ powers, dtype=np.int64)
