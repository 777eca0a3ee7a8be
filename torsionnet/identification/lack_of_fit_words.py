"""Sentences on lack of fit, which say that a model does not fit, what would explain that and what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator

from torsionnet.base.number_text import value_with_error
from torsionnet.identification.lack_of_fit import Explanation, LackOfFit

ADVICE_BY_CAUSE = {
    "delay": "find it along (delay: true) or mend the channel",
    "gain": "find it along (gain: true), or look for a wrong ratio, calibration or sign",
    "hysteretic": "give the spring a loss factor instead of a viscous damping",
    "viscous": "give the spring a viscous damping instead of a loss factor",
    "reference_angle": "find it along (reference_angle: true), or correct where the reference stands",
    "misfire": "look at its injection, or find the share along",
    "gas_torque": "look at its injection, or find the factor along",
    "ratio": "look for other teeth, or correct the ratio",
    "value": "free it too, or correct it",
    "between": "say so by between, in the signal or in the measurement",
}
INTERVALS_WITHHELD = "Intervals are withheld"
MOST_EXPLANATIONS_LISTED = 3
"""Number of explanations of a misfit that a sentence lists at most, as more would hide the first."""


def lack_of_fit_sentences(lack: LackOfFit | None) -> Iterator[str]:
    """Sentence on a model that does not fit, with explanation and advice; no sentence if the model fits."""
    if lack is None or not lack.rejected:
        return
    wrong = [one for one in lack.measurements if one.rejected]
    where = "" if len(lack.measurements) == 1 else f" {', '.join(one.name for one in wrong)}"
    worst = max(one.ratio for one in wrong)
    says = f"the model does not fit{where}: the residuals are {worst:.2g} times the noise, in a pattern over frequency"
    withheld = "; ".join([INTERVALS_WITHHELD, *lack.data_warnings])
    if not lack.explanations:
        yield (
            f"{says}; no delay, gain, other kind of damping or single other value explains it: look at the residuals, "
            f"or try other starts. {withheld}"
        )
        return
    best, *others = lack.explanations
    verb = "would explain it" if best.complete else "would explain most of it"
    explained = [
        f"{_what(best)} {verb}: {_values(best)}",
        *(f"so would {_what(one)}: {_values(one)}" for one in others),
    ]
    yield f"{says}; {'; '.join(explained[:MOST_EXPLANATIONS_LISTED])}; {ADVICE_BY_CAUSE[best.kind]}. {withheld}"


def _what(one: Explanation) -> str:
    found = [value for name, value in one.values.items() if name.partition("[")[0] == one.unknown]
    return cause_in_words(one.kind, one.of, sum(found) / max(len(found), 1), one.before, one.between)


def cause_in_words(kind: str, of: str, value: float, before: float | None, between: str = "") -> str:
    """Description in words of a cause of a misfit with the value that it would need.

    >>> cause_in_words("gain", "n_out", 0.7767, None), cause_in_words("ratio", "stage.ratio", 2.33, 3.0)
    ('a gain of 0.7767 in n_out', 'stage.ratio = 2.33 instead of 3')
    >>> cause_in_words("gain", "theta_1", -1.002, None)
    'a gain of -1.002 in theta_1 (a channel is reversed)'
    >>> cause_in_words("between", "T_M", float("nan"), None, "band_limited")
    'T_M band-limited between samples'
    """
    if between:
        return f"{of} {between.replace('_', '-')} between samples"
    if kind == "delay":
        return f"a delay of {1e3 * value:.3g} ms in {of}"
    if kind == "gain":
        return f"a gain of {value:.4g} in {of}{' (a channel is reversed)' * (value < 0)}"
    if kind == "reference_angle":
        return f"a reference angle of {math.degrees(value):.4g} deg in {of}"
    if kind == "misfire":
        return f"a misfire of {of} ({100 * value:.3g} % of its injection lost)"
    if kind == "gas_torque":
        return f"a gas torque of {of} {value:.3g} times that of the others"
    if kind == "hysteretic":
        return f"hysteretic instead of viscous damping in {of} (loss factor {value:.3g})"
    if kind == "viscous":
        return f"viscous instead of hysteretic damping in {of} ({value:.3g} N*m*s/rad)"
    return f"{of} = {value:.4g} instead of {before:.4g}"


def _values(one: Explanation) -> str:
    """Text with the values that all other parameters would have if an explanation of a misfit were true."""
    listed = [
        f"{name} would be {value_with_error(value, one.standard_errors[name])}"
        for name, value in one.values.items()
        if name.partition("[")[0] != one.unknown
    ]
    return ", ".join(listed) or "nothing else changes"
