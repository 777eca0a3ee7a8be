"""Values that run to a limit of what they can be: the data do not show them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from torsionnet.assembly.rows import FloatArray
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.natures import Nature
from torsionnet.identification.search import cannot_be_negative

FAR = 1e3
"""Factor from the start."""
UNSEEN = 0.1
"""Standard deviations of all residuals together by which the data change on the rest of the way."""
ENDLESS = {
    "stiffness": "the data do not show that it gives way; make it rigid",
    "inertia": "the data do not show that it moves; lock its node",
    "damping": "the data do not show that it slips; make it rigid",
}


def at_limits(
    problem: FitProblem, values: FloatArray, natures: Mapping[str, Nature]
) -> tuple[FloatArray, dict[str, str]]:
    """The values, 0 instead of what is as good as 0, and by name a sentence for what ran to zero or without end."""
    residuals, slopes = problem.both(values)
    spread = np.sqrt(float(residuals @ residuals) / max(len(residuals) - len(values), 1))
    effect = np.linalg.norm(slopes, axis=0) * np.abs(values)
    unseen = cannot_be_negative(problem) & (effect <= UNSEEN * max(spread, np.finfo(float).tiny))
    ended, said = values.copy(), {}
    for index in np.flatnonzero(unseen):
        name, factor = problem.names[index], values[index] / problem.start[index]
        kind = natures.get(name.partition("[")[0], Nature()).dimension
        if factor < 1 / FAR and problem.lower[index] == 0:
            what = kind if kind in ENDLESS else "parameter"
            said[name] = f"{name} runs to zero: the data do not show this {what}; leave it out"
            ended[index] = 0.0
        elif factor > FAR:
            said[name] = f"{name} grows without end: {ENDLESS.get(kind, 'the data set it no upper end; leave it out')}"
    return ended, said
