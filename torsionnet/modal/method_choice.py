"""Stabilisation diagram by the better of two methods, rational fraction (few modes) or LSCF (many light ones)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from torsionnet.base.errors import SolveError
from torsionnet.base.threads import one_thread
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.schwarz_criterion import BicCriterion, pole_count, weighted_residuals
from torsionnet.modal.selection import SelectedPoles, Selection, select
from torsionnet.modal.settings import DEFAULT_HIGHEST_ORDER, Method, Settings
from torsionnet.modal.stabilisation_chart import Stabilisation, diagram

NAMES: Mapping[Method, str] = {"rational": "rational fraction", "lscf": "LSCF"}
"""Name of each identification method in the sentence that explains the choice of the method."""
CLEAR_BIC_DIFFERENCE = 10.0
"""Difference of BIC between two methods above which the worse one has next to no support (Kass and Raftery 1995)."""


@one_thread()
def stabilisation(response: FrequencyResponse, settings: Settings | None = None) -> Stabilisation:
    """Stabilisation diagram of a response, with the poles of all orders and which of them stay between orders.

    Parameters
    ----------
    response : FrequencyResponse
        One or several transfer functions of one test: they share their poles.
    settings : Settings, optional
        With the method ``auto`` both are run, and the diagram is that of the rational fraction unless the modes of LSCF
        have a clearly lower Schwarz criterion (BIC) over the same lines.

    Raises
    ------
    UsageError
        There are too few frequencies, or channels that no modes are fitted to.
    SolveError
        No order has a stable pole.

    Examples
    --------
    >>> import numpy as np
    >>> import torsionnet as tn
    >>> rig = tn.load("amt_rig").configured("II")
    >>> diagram = stabilisation(rig.frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.1)))
    >>> diagram.at(4).poles.round(3).tolist()
    [(-6.07+24.035j), (-38.561+76.597j)]
    """
    chosen = settings or Settings()
    return _chosen(response, chosen) if chosen.method == "auto" else diagram(response, chosen)


def _chosen(response: FrequencyResponse, settings: Settings) -> Stabilisation:
    """Diagram of the method whose modes have the lower BIC, the rational fraction unless the difference is clear."""
    plans: tuple[tuple[Method, Selection, int], ...] = (
        ("rational", "order", min(DEFAULT_HIGHEST_ORDER["rational"], settings.order)),
        ("lscf", "clusters", settings.order),
    )
    found: dict[Method, Stabilisation] = {}
    taken: dict[Method, SelectedPoles] = {}
    failure: SolveError | None = None
    for method, rule, order in plans:
        try:
            found[method] = diagram(response, replace(settings, method=method, highest_order=order))
            taken[method] = select(found[method], rule)
        except SolveError as error:
            failure = failure or error
    if not taken:
        assert failure is not None
        raise failure
    if len(taken) == 1:
        (only,) = taken
        (other,) = NAMES.keys() - taken.keys()
        return replace(found[only], choice=f"{NAMES[only]}, since {NAMES[other]} finds no stable pole")
    better = _advantage(found["rational"], taken["rational"], taken["lscf"])
    best, rest = tuple(NAMES)[:: -1 if better > CLEAR_BIC_DIFFERENCE else 1]
    how = f"{abs(better):.4g} higher" if abs(better) > CLEAR_BIC_DIFFERENCE else "no better"
    return replace(found[best], choice=f"{NAMES[best]} rather than {NAMES[rest]}, whose BIC is {how}")


def _advantage(diagram: Stabilisation, taken: SelectedPoles, other: SelectedPoles) -> float:
    """BIC of the first choice of poles less that of the second, both with the noise of the better fit."""
    both = (taken, other)
    left = [weighted_residuals(diagram.lines, one.poles, one.participations, diagram.settings) for one in both]
    criterion = BicCriterion(diagram.lines, min(left, key=lambda one: float((abs(one) ** 2).sum())))
    first, second = (criterion.value(rest, pole_count(one.poles)) for rest, one in zip(left, both, strict=True))
    return first - second
