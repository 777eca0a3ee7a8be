"""That a model does not fit, in words, and what would explain it."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.core.number_text import with_error
from torsionnet.identification.lack_of_fit import Explanation, LackOfFit

AGREED = {
    "delay": "find it along (delay: true) or mend the channel",
    "gain": "find it along (gain: true), or look for a wrong ratio, calibration or sign",
    "hysteretic": "give the spring a loss factor instead of a viscous damping",
    "viscous": "give the spring a viscous damping instead of a loss factor",
    "ratio": "look for other teeth, or correct the ratio",
    "value": "free it too, or correct it",
}
WITHHELD = "Intervals are withheld"
MOST_TOLD = 3


def lacking(lack: LackOfFit | None) -> Iterator[str]:
    """One sentence, and what to do, if the model does not fit."""
    if lack is None or not lack.rejected:
        return
    wrong = [one for one in lack.measurements if one.rejected]
    where = "" if len(lack.measurements) == 1 else f" {', '.join(one.name for one in wrong)}"
    worst = max(one.ratio for one in wrong)
    says = f"the model does not fit{where}: the residuals are {worst:.2g} times the noise, in a pattern over frequency"
    withheld = "; ".join([WITHHELD, *lack.doubts])
    if not lack.explanations:
        yield (
            f"{says}; no delay, gain, other kind of damping or single other value explains it: look at the residuals, "
            f"or try other starts. {withheld}"
        )
        return
    best, *others = lack.explanations
    verb = "would explain it" if best.complete else "would explain most of it"
    told = [f"{_what(best)} {verb}: {_values(best)}", *(f"so would {_what(one)}: {_values(one)}" for one in others)]
    yield f"{says}; {'; '.join(told[:MOST_TOLD])}; {AGREED[best.kind]}. {withheld}"


def _what(one: Explanation) -> str:
    found = [value for name, value in one.values.items() if name.partition("[")[0] == one.unknown]
    return cause_in_words(one.kind, one.of, sum(found) / len(found), one.before)


def cause_in_words(kind: str, of: str, value: float, before: float | None) -> str:
    """A cause and its size.

    >>> cause_in_words("gain", "n_out", 0.7767, None), cause_in_words("ratio", "stage.ratio", 2.33, 3.0)
    ('a gain of 0.7767 in n_out', 'stage.ratio = 2.33 instead of 3')
    >>> cause_in_words("gain", "theta_1", -1.002, None)
    'a gain of -1.002 in theta_1 (a channel is reversed)'
    """
    if kind == "delay":
        return f"a delay of {1e3 * value:.3g} ms in {of}"
    if kind == "gain":
        return f"a gain of {value:.4g} in {of}{' (a channel is reversed)' * (value < 0)}"
    if kind == "hysteretic":
        return f"hysteretic instead of viscous damping in {of} (loss factor {value:.3g})"
    if kind == "viscous":
        return f"viscous instead of hysteretic damping in {of} ({value:.3g} N*m*s/rad)"
    return f"{of} = {value:.4g} instead of {before:.4g}"


def _values(one: Explanation) -> str:
    """The other parameters then."""
    listed = [
        f"{name} would be {with_error(value, one.standard_errors[name])}"
        for name, value in one.values.items()
        if name.partition("[")[0] != one.unknown
    ]
    return ", ".join(listed) or "nothing else changes"
