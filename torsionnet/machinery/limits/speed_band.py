"""Band of speed ratios in which a limit holds in continuous operation; other speeds are only passed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, Value
from torsionnet.base.entries.spec import EntryError, Schema, Spec, entry
from torsionnet.base.errors import Fault, got
from torsionnet.base.units import RPM
from torsionnet.machinery.limits.evidence import Evidence, LimitSubject
from torsionnet.machinery.limits.limit import Limit, LimitLine
from torsionnet.machinery.verdicts.limit_verdict import BARRED, FAIL, LimitVerdict
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, joined_spans, spans_above

BAND_FORMS = "95..105 % or [0.95, 1.05]"
"""Example of how a band of speed ratios is written, for messages and schemas."""
LARGEST_RATIO = 3.0
"""Largest speed ratio of a band, as no machine runs at three times its rated speed; more is probably meant in per
cent."""
_EDGE = Value("a speed over the rated speed", "1")


class RatedSpeedBand(Spec[tuple[float, float]]):
    """Entry of a band of speed ratios: two shares of the rated speed, the lower one first."""

    def coerce(self, raw: object) -> tuple[float, float]:
        edges = raw
        if isinstance(raw, str) and raw.count("..") == 1:
            low, high = (part.strip() for part in raw.split(".."))
            edges = (low if low.endswith("%") or not high.endswith("%") else f"{low} %", high)
        if not (isinstance(edges, list | tuple) and len(edges) == 2):
            raise EntryError(f"expected a band of the rated speed such as {BAND_FORMS}, {got(raw)}", kind="wrong-form")
        first, last = (_EDGE.coerce(edge) for edge in edges)
        if not 0 <= first < last <= LARGEST_RATIO:
            raise EntryError(
                f"a band of the rated speed rises and ends at {LARGEST_RATIO:g}, as {BAND_FORMS}; {got(raw)}",
                kind="unordered-rows",
            )
        return first, last

    def plain(self, value: tuple[float, float]) -> list[float]:
        return list(value)

    def schema(self) -> Schema:
        pair: Schema = {"type": "array", "items": SCALAR_SCHEMA, "minItems": 2, "maxItems": 2}
        return {"description": f"{self.description}: {BAND_FORMS}", "anyOf": [{"type": "string"}, pair]}

    @property
    def accepted(self) -> str:
        return "str | tuple[Scalar, Scalar] | list[Scalar] | list[float] | list[str]"


@dataclass(frozen=True, kw_only=True)
class InSpeedBand(Limit):
    """Base of limits that may hold in a band of the rated speed alone, as of generating sets.

    In the band no range can be barred, also with a cylinder out; outside, speeds are only passed, and what holds in
    continuous operation is not judged there. A condition that permits no speed of the band runs below it: there the
    limit is judged, too, but for one that means nothing outside its band.
    """

    holds_in_band_alone: ClassVar[bool] = False
    """Whether the limit means nothing at speeds outside its band, as the angle of a generator that is not connected."""

    speed_band: tuple[float, float] | None = entry(
        RatedSpeedBand("speeds over the rated speed at which the machine runs; default: all that are examined"), None
    )

    def unfit(self, subject: LimitSubject) -> Iterator[Fault]:
        yield from super().unfit(subject)
        if self.speed_band and subject.rated is None:
            text = "a band of the rated speed needs that speed: speeds: {rated: 900 rpm}"
            yield Fault(text, ("speed_band",), on_key=True, about="speeds", kind="missing-entry")

    def breaks(self, subject: LimitSubject) -> list[float]:
        edges = [edge * (subject.rated or math.nan) for edge in self.speed_band or ()]
        return [*super().breaks(subject), *edges]

    def known_lines(self, evidence: Evidence) -> list[LimitLine]:
        lines = super().known_lines(evidence)
        return [self._within_band(line, evidence) for line in lines] if self.speed_band else lines

    def _within_band(self, line: LimitLine, evidence: Evidence) -> LimitLine:
        if line.why_not or line.in_passing:
            return line
        low, high = self._edges(evidence)
        inside = (evidence.speeds >= low * (1 - 1e-12)) & (evidence.speeds <= high * (1 + 1e-12))
        if evidence.run_below is not None and not self.holds_in_band_alone:
            inside |= evidence.speeds <= evidence.run_below * (1 + 1e-12)
        return replace(line, allowed=np.where(inside, line.allowed, np.nan))

    def running(self, line: LimitLine, evidence: Evidence) -> SpeedSpan | None:
        """Speeds in rad/s at which the machine runs by the band, as far as they are examined; None without a band.

        Of a limit that holds while speeds are passed, too, there is none.
        """
        if self.speed_band is None or line.in_passing:
            return None
        return SpeedSpan(*self._edges(evidence)).within(evidence.examined)

    def _edges(self, evidence: Evidence) -> tuple[float, float]:
        """Lowest and highest speed of the band in rad/s."""
        low, high = self.speed_band or (0.0, math.inf)
        rated = evidence.subject.rated or math.nan
        return low * rated, high * rated

    def judged(self, line: LimitLine, name: str, evidence: Evidence) -> Iterator[LimitVerdict]:
        if self.speed_band and not line.why_not and not np.isfinite(line.allowed).any():
            # A condition at other speeds, as idling, is judged by what holds there; others judge the band.
            outside = self.open(name, evidence, line.criterion, "no speed examined lies in the speed band")
            yield replace(outside, absent=True, elsewhere=True)
        else:
            yield from super().judged(line, name, evidence)

    def continuous(self, line: LimitLine, name: str, evidence: Evidence) -> LimitVerdict:
        above = spans_above(evidence.speeds, line.values, line.allowed) if self.speed_band else []
        if not above:
            return super().continuous(line, name, evidence)
        if self.holds_in_band_alone:
            # Whoever passes the range does no harm with it: it is not run, and what lies above is reached.
            spans = [span.widened(self.tolerance).within(evidence.examined) for span in above]
            text = f"exceeded from {above[0]} in the speed band: not to be run there, passing does no harm"
            return self._verdict(line, name, evidence, FAIL, joined_spans(spans), (text,))
        # Below the band, where a condition runs that permits no speed of it, ranges can be barred.
        low = self._edges(evidence)[0]
        below = [self._up_to_permitted(span, evidence) for span in above if span.high < low]
        barred = joined_spans([span.widened(self.tolerance).within(evidence.examined) for span in below])
        if len(below) == len(above):
            return self._verdict(line, name, evidence, BARRED, barred, ())
        text = f"exceeded from {above[len(below)]} in the speed band, where no range can be barred"
        return self._verdict(line, name, evidence, FAIL, barred, (text,))

    def _up_to_permitted(self, span: SpeedSpan, evidence: Evidence) -> SpeedSpan:
        """Range of speeds below the band, up to the highest one permitted where no examined speed lies between."""
        top = evidence.run_below or span.high
        between = (evidence.speeds > span.high) & (evidence.speeds <= top)
        return span if between.any() else SpeedSpan(span.low, top)

    def remarks(self, line: LimitLine, evidence: Evidence) -> tuple[str, ...]:
        said = super().remarks(line, evidence)
        if not self.speed_band or line.in_passing:
            return said
        low, high = self._edges(evidence)
        band = f"holds from {low * RPM:.6g} to {high * RPM:.6g} rpm, where the machine runs"
        first, last = evidence.examined.low, evidence.examined.high
        if first > low * (1 + 1e-9) or last < high * (1 - 1e-9):
            band += f"; examined from {max(low, first) * RPM:.6g} to {min(high, last) * RPM:.6g} rpm"
        if evidence.run_below is not None and not self.holds_in_band_alone:
            band += f"; no speed of it is permitted: judged up to {evidence.run_below * RPM:.6g} rpm, too"
        return (*said, band)
