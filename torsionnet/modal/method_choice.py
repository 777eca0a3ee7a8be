"""Which method fits the modes: few of any damping, or many light ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from torsionnet.core.errors import SolveError
from torsionnet.core.threads import one_thread
from torsionnet.modal.information import Judge, count_of, left_over
from torsionnet.modal.selection import Selected, Selection, select
from torsionnet.modal.settings import HIGHEST, Method, Settings
from torsionnet.modal.stabilisation import Stabilisation, diagram
from torsionnet.response import FrequencyResponse

NAMES: Mapping[Method, str] = {"rational": "rational fraction", "lscf": "LSCF"}
CLEAR = 10.0
"""Difference of the criterion that leaves next to no support to the worse one (Kass and Raftery 1995)."""


@one_thread()
def stabilisation(response: FrequencyResponse, settings: Settings | None = None) -> Stabilisation:
    """Poles of all orders up to the highest, and which of them stay from one order to the next.

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
    """That of the two diagrams whose modes have the lower criterion; the simpler method unless it is clear."""
    plans: tuple[tuple[Method, Selection, int], ...] = (
        ("rational", "order", min(HIGHEST["rational"], settings.order)),
        ("lscf", "clusters", settings.order),
    )
    found: dict[Method, Stabilisation] = {}
    taken: dict[Method, Selected] = {}
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
    best, rest = tuple(NAMES)[:: -1 if better > CLEAR else 1]
    how = f"{abs(better):.4g} higher" if abs(better) > CLEAR else "no better"
    return replace(found[best], choice=f"{NAMES[best]} rather than {NAMES[rest]}, whose BIC is {how}")


def _advantage(diagram: Stabilisation, taken: Selected, other: Selected) -> float:
    """By how much the criterion of the second poles is lower, judged by the same noise."""
    both = (taken, other)
    left = [left_over(diagram.lines, one.poles, one.participations, diagram.settings) for one in both]
    judge = Judge(diagram.lines, min(left, key=lambda one: float((abs(one) ** 2).sum())))
    first, second = (judge.criterion(rest, count_of(one.poles)) for rest, one in zip(left, both, strict=True))
    return first - second
