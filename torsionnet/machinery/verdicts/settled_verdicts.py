"""Verdicts on all limits of one condition together: what one of them refuses, no other one bars or reduces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from torsionnet.base.phrases import phrase
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.machinery.verdicts.limit_verdict import BARRED, FAIL, REDUCED, LimitVerdict
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan, joined_spans

NOT_PASSED = "{span} is not passed: in this condition no speed above {speed:.5g} rpm is permitted"
"""Remark on a range that a limit would bar, and that another one does not let be passed."""
NOT_KEPT = "another limit is not kept in this condition"
"""Remark on a limit that would hold up to a highest speed in a condition in which another limit does not hold."""


def highest_permitted(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> float | None:
    """Highest speed in rad/s below all ranges that may not be passed; None where every speed is reached.

    It is the low end of the first range that a limit refuses, joined with the barred ranges that overlap it. Where
    that is the lowest speed examined, no speed is permitted.
    """
    refused = [span for one in verdicts for span in one.refused]
    refused += [SpeedSpan(one.highest, float(speeds[-1])) for one in verdicts if one.highest is not None]
    ranges = joined_spans([*refused, *(span for one in verdicts for span in one.barred)])
    return min((one.low for one in ranges if any(one.holds(span.low) for span in refused)), default=None)


def settled(verdicts: Sequence[LimitVerdict], speeds: FloatArray) -> tuple[LimitVerdict, ...]:
    """Verdicts of one condition of which none contradicts another one.

    A range barred by one limit is not passed where another one refuses that range or one below it; and no limit is
    kept by a reduced speed in a condition in which another one fails.
    """
    highest = highest_permitted(verdicts, speeds)
    if highest is None:
        return tuple(verdicts)
    fails = any(one.verdict == FAIL and one.refused for one in verdicts)
    return tuple(_settled(one, highest, fails=fails) for one in verdicts)


def _settled(one: LimitVerdict, highest: float, *, fails: bool) -> LimitVerdict:
    if one.verdict not in (BARRED, REDUCED):
        return one
    above = tuple(span for span in one.barred if span.high > highest)
    kept = tuple(span for span in one.barred if span not in above)
    said = [phrase(NOT_PASSED, span=span, speed=highest * RPM) for span in above]
    if fails and one.verdict == REDUCED:
        return replace(one, verdict=FAIL, barred=kept, unpassed=above, remarks=(NOT_KEPT, *one.remarks))
    if not above or one.verdict == REDUCED:
        return one
    if fails:
        return replace(one, verdict=FAIL, barred=kept, unpassed=above, remarks=(*said, *one.remarks))
    return replace(one, verdict=REDUCED, highest=above[0].low, remarks=(*said, *one.remarks))
