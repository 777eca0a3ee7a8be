"""Choice of the poles of a stabilisation diagram that are modes, by order, by clusters, or by hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.threads import one_thread
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.matrix_fraction import Stabilisation, damping_ratios, diagram, natural_frequencies
from torsionnet.modal.residues import expand
from torsionnet.modal.spectral_lines import DEFAULT_HIGHEST_ORDER, ComplexArray, Lines, Method, Settings

# Schwarz criterion (BIC) of fits with different numbers of poles, misfit against number of unknowns.

ROUND_OFF = 1e-9
"""RMS residual over RMS response below which a fit counts as exact, as a smaller one is rounding and must not favour
more poles."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of residuals at neighbouring lines that is assumed, as at 1 the number of equations would be
0."""


def line_correlation(left: ComplexArray) -> float:
    """Correlation, 0 to 0.95, of a fit's residuals (n_f, ...) at neighbouring lines, which windows cause."""
    total = max(float(np.sum(np.abs(left) ** 2)), np.finfo(float).tiny)
    return float(np.clip(np.sum(left[1:] * left[:-1].conj()).real / total, 0, LARGEST_CORRELATION))


@dataclass(frozen=True, eq=False)
class BicCriterion:
    """Schwarz criterion (BIC) for fits of the same lines, of which the one with the lowest value is the best.

    Attributes
    ----------
    lines : Lines
    noise : (n_f, n_out, n_in) complex array
        Weighted residuals of the best fit; where neighbouring lines are correlated they count for less.
    """

    lines: Lines
    noise: ComplexArray

    def value(self, left: ComplexArray, poles: int) -> float:
        """Schwarz criterion of a fit from its weighted residuals and its number of poles (both of each pair)."""
        count, outputs, inputs = left.shape
        size = np.mean(np.abs(self.lines.weights * self.lines.values) ** 2, axis=0)
        squares = np.maximum(np.mean(np.abs(left) ** 2, axis=0), ROUND_OFF**2 * size)
        same = line_correlation(self.noise)
        # Complex lines are two equations each, those that correlate by rho (1 - rho)/(1 + rho) of that.
        equations = 2 * count * (1 - same) / (1 + same)
        residues = outputs if self.lines.drive is None else 2 * outputs  # of a record, and those of its transients
        unknowns = poles * (residues + inputs)
        return float(equations * np.log(squares).sum() + unknowns * np.log(max(2, equations * squares.size)))


def significant_poles(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> list[int]:
    """Indices of the poles kept when the least useful pole is dropped again and again while that lowers the BIC."""
    kept = list(range(len(poles)))
    left = weighted_residuals(lines, poles, rows, settings)
    criterion = BicCriterion(lines, left)
    best = criterion.value(left, pole_count(poles))
    while len(kept) > 1:
        trials = []
        for place in kept:
            rest = [other for other in kept if other != place]
            trials.append(
                (
                    criterion.value(
                        weighted_residuals(lines, poles[rest], rows[rest], settings), pole_count(poles[rest])
                    ),
                    place,
                )
            )
        # Backward elimination by the BIC.
        least, place = min(trials)
        if least >= best:
            break
        best = least
        kept.remove(place)
    return kept


def weighted_residuals(lines: Lines, poles: ComplexArray, rows: ComplexArray, settings: Settings) -> ComplexArray:
    """Weighted residuals (n_f, n_out, n_in) of a fit with given poles and their best residues, complex."""
    expansion = expand(lines, poles, settings, rows)
    return np.asarray(lines.weights * (lines.values - expansion.values(lines.s, lines.powers)))


def pole_count(poles: ComplexArray) -> int:
    """Number of poles with both of each conjugate pair counted, from a list with one of each."""
    return int(np.sum(1 + (poles.imag != 0)))


def best_order(lines: Lines, left: list[ComplexArray]) -> int:
    """Index (from 0) of the order of a fit with the lowest BIC, from the weighted residuals of each order."""
    squares = [np.log(np.maximum(np.mean(np.abs(each) ** 2, axis=0), np.finfo(float).tiny)).sum() for each in left]
    criterion = BicCriterion(lines, left[int(np.argmin(squares))])
    inputs = lines.values.shape[2]
    return int(np.argmin([criterion.value(each, (place + 1) * inputs) for place, each in enumerate(left)]))


Selection: TypeAlias = Literal["order", "clusters"] | int | Sequence[tuple[int, float]]


@dataclass(frozen=True, eq=False)
class SelectedPoles:
    """Poles (rad/s) chosen from a stabilisation diagram as modes, with the participations of the inputs.

    Attributes
    ----------
    poles : (n,) complex array
        rad/s, sorted by magnitude.
    participations : (n, n_in) complex array
    seen : tuple of int
        Number of orders of the diagram at which each pole is found.
    rule : str
        Rule of the choice in words, for titles.
    automatic : bool
        Whether a rule chose them, and not the user.
    """

    poles: ComplexArray
    participations: ComplexArray
    seen: tuple[int, ...]
    rule: str
    automatic: bool = False


Place: TypeAlias = tuple[int, int]
"""Place of a pole in a stabilisation diagram, index of an order and index of the pole in that order."""

CLOSE_MODES = 0.5
"""Distance of two poles over the sum of their decay rates below which modes count as close, as residues of close modes
are split badly between them; a larger value leaves more poles unrefined."""
WINDOW_LINES = 2.0
"""Distance in lines of an estimate, beyond that of close modes, up to which windows cannot part poles: half the width
of a window's main lobe."""
FARTHEST_PICK = 0.2
"""Distance of the nearest pole from a frequency picked by hand, over that frequency, above which the pick is refused as
a mistake."""


def select(diagram: Stabilisation, selection: Selection) -> SelectedPoles:
    """Poles of a stabilisation diagram chosen as modes by a selection; see :func:`torsionnet.modal.identify_modes`."""
    if selection == "clusters":
        places = clusters(diagram)
        rule = f"stable over at least {diagram.settings.criteria.enough(len(diagram.orders))} orders in a row"
        if not places:
            raise SolveError(
                f"no pole is {rule}; look at the stabilisation diagram and choose by hand", kind="no-resonance"
            )
    elif selection == "order" or isinstance(selection, int):
        index = (
            best_order(diagram.lines, [order.residuals for order in diagram.orders])
            if selection == "order"
            else _order(diagram, selection) - 1
        )
        places = [(index, pole) for pole in range(len(diagram.orders[index].poles))]
        rule = f"all of order {index + 1}" + (", which is worth its unknowns (BIC)" if selection == "order" else "")
        if not places:
            raise SolveError(
                f"order {index + 1} has no stable pole; choose another order or a narrower band", kind="no-resonance"
            )
    elif isinstance(selection, str):
        raise UsageError(
            f'select="{selection}" is not known; choose "order", "clusters", an order, or (order, Hz) pairs',
            kind="unknown-word",
        )
    else:
        places = list(dict.fromkeys(_by_hand(diagram, selection)))
        rule = "chosen by hand"
    return _collected(diagram, places, rule, automatic=selection in ("order", "clusters"))


def merged(response: FrequencyResponse, poles: ComplexArray) -> ComplexArray:
    """Poles (rad/s) of an estimate by windows, of which those that these cannot part are one.

    A window smears a peak into one that is no quotient of polynomials: a fit gives it two poles or more.
    """
    origin = response.estimation
    spacing = float(np.diff(response.frequencies).min()) if origin is None else 1 / origin.seconds
    kept: list[complex] = []
    for pole in poles[np.argsort(poles.imag)]:
        # Width of the windows and of both peaks together: poles nearer than that are one peak.
        width = 2 * np.pi * WINDOW_LINES * spacing - CLOSE_MODES * (pole.real + (kept[-1].real if kept else 0))
        if kept and kept[-1].imag and pole.imag - kept[-1].imag < width:
            kept[-1] = (kept[-1] + complex(pole)) / 2
        else:
            kept.append(complex(pole))
    return np.array(sorted(kept, key=abs))


def clusters(diagram: Stabilisation) -> list[Place]:
    """Places, in a stabilisation diagram, of one pole for each chain of poles that stay stable over enough orders.

    A chain leads from each pole to its partner at the order before, the longest chains first; the pole nearest to its
    median represents it. A chain with frequency and damping of another is a separate mode only if some order has poles
    of both.
    """
    low, high = np.abs(diagram.lines.s[[0, -1]])
    enough = diagram.settings.criteria.enough(len(diagram.orders))
    taken: set[Place] = set()
    kept: list[tuple[Place, list[Place]]] = []
    # The longest chains first, so that a pole goes to the mode that stays over most orders.
    for chain in sorted(_chains(diagram), key=len, reverse=True):
        own = [place for place in chain if place not in taken]
        if len(own) < enough:
            continue
        taken.update(own)
        place = _middle(diagram, own)
        like = [number for number, (other, _) in enumerate(kept) if _is_same(diagram, place, other)]
        if like:
            # At one order the shapes of a repeated pole are independent, between orders they are not.
            chains = [own, *(kept[number][1] for number in like)]
            shared = set[int].intersection(*({index for index, _ in chain} for chain in chains))
            if not shared:
                continue
            last = max(shared)
            place = _at(own, last)
            for number in like:
                kept[number] = _at(kept[number][1], last), kept[number][1]
        if low <= abs(_pole(diagram, place)) <= high:
            kept.append((place, own))
    return [place for place, _ in kept]


def _at(chain: list[Place], index: int) -> Place:
    return next(place for place in chain if place[0] == index)


def _pole(diagram: Stabilisation, place: Place) -> complex:
    return complex(diagram.orders[place[0]].poles[place[1]])


def _middle(diagram: Stabilisation, chain: list[Place]) -> Place:
    values = np.array([_pole(diagram, place) for place in chain])
    middle = np.median(values.real) + 1j * np.median(values.imag)
    return chain[int(np.abs(values - middle).argmin())]


def _chains(diagram: Stabilisation) -> Iterator[list[Place]]:
    for index, order in enumerate(diagram.orders):
        for pole in range(len(order.poles)):
            chain = [(index, pole)]
            while diagram.orders[chain[-1][0]].stable[chain[-1][1]]:
                at, own = chain[-1]
                chain.append((at - 1, int(diagram.orders[at].partners[own])))
            yield chain


def _is_same(diagram: Stabilisation, first: Place, second: Place) -> bool:
    """Whether two poles of a stabilisation diagram agree in frequency and damping ratio."""
    criteria = diagram.settings.criteria
    a, b = _pole(diagram, first), _pole(diagram, second)
    return bool(
        abs(abs(a) / abs(b) - 1) <= criteria.frequency
        and abs(damping_ratios(a) / damping_ratios(b) - 1) <= criteria.damping
    )


def _order(diagram: Stabilisation, order: int) -> int:
    if not 1 <= order <= len(diagram.orders):
        raise UsageError(
            f"there is no order {order} in the diagram; the orders are 1 to {len(diagram.orders)}", kind="out-of-range"
        )
    return order


def _by_hand(diagram: Stabilisation, picks: Sequence[tuple[int, float]]) -> Iterator[Place]:
    if not picks:
        raise UsageError("no pole is chosen; give (order, Hz) pairs", kind="wrong-count")
    for pick in picks:
        try:
            order, frequency = int(pick[0]), float(pick[1])
        except (TypeError, ValueError, IndexError) as error:
            raise UsageError(
                f"a pole is chosen by its order and frequency in Hz, as in (6, 8.7); got {pick!r}", kind="wrong-form"
            ) from error
        index = _order(diagram, order) - 1
        known = natural_frequencies(diagram.orders[index].poles)
        if not len(known):
            raise UsageError(f"order {order} has no stable pole; choose another order", kind="no-resonance")
        nearest = int(np.abs(known - frequency).argmin())
        if abs(known[nearest] / frequency - 1) > FARTHEST_PICK:
            there = ", ".join(f"{value:.4g}" for value in known)
            raise UsageError(
                f"order {order} has no pole near {frequency:g} Hz; its poles are at {there} Hz", kind="no-resonance"
            )
        yield index, nearest


def _collected(diagram: Stabilisation, places: list[Place], rule: str, *, automatic: bool) -> SelectedPoles:
    """Poles at the given places of a diagram, of an automatic choice only those that lower the criterion (BIC)."""
    places = sorted(places, key=lambda place: abs(diagram.orders[place[0]].poles[place[1]]))
    poles = np.array([diagram.orders[index].poles[pole] for index, pole in places])
    rows = np.array([diagram.orders[index].participations[pole] for index, pole in places])
    kept = significant_poles(diagram.lines, poles, rows, diagram.settings) if automatic else list(range(len(places)))
    seen = tuple(_seen(diagram, places[number]) for number in kept)
    return SelectedPoles(poles[kept], rows[kept], seen, rule, automatic)


def _seen(diagram: Stabilisation, place: Place) -> int:
    return sum(
        any(_is_same(diagram, place, (index, pole)) for pole in range(len(order.poles)))
        for index, order in enumerate(diagram.orders)
    )


# Stabilisation diagram by the better of two methods, rational fraction (few modes) or LSCF (many light ones).

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
    return _diagram_of_lower_bic(response, chosen) if chosen.method == "auto" else diagram(response, chosen)


def _diagram_of_lower_bic(response: FrequencyResponse, settings: Settings) -> Stabilisation:
    """Diagram of the method whose modes have the lower BIC, the rational fraction unless the difference is clear."""
    plans: tuple[tuple[Method, Selection, int], ...] = (
        ("rational", "order", min(DEFAULT_HIGHEST_ORDER["rational"], settings.order)),
        ("lscf", "clusters", settings.order),
    )
    diagrams: dict[Method, Stabilisation] = {}
    taken: dict[Method, SelectedPoles] = {}
    failure: SolveError | None = None
    for method, rule, order in plans:
        try:
            diagrams[method] = diagram(response, replace(settings, method=method, highest_order=order))
            taken[method] = select(diagrams[method], rule)
        except SolveError as error:
            failure = failure or error
    if not taken:
        assert failure is not None
        raise failure
    if len(taken) == 1:
        (only,) = taken
        (other,) = NAMES.keys() - taken.keys()
        return replace(diagrams[only], choice=f"{NAMES[only]}, since {NAMES[other]} finds no stable pole")
    # Both by one criterion, with the noise of the better fit.
    better = _advantage(diagrams["rational"], taken["rational"], taken["lscf"])
    best, rest = tuple(NAMES)[:: -1 if better > CLEAR_BIC_DIFFERENCE else 1]
    how = f"{abs(better):.4g} higher" if abs(better) > CLEAR_BIC_DIFFERENCE else "no better"
    return replace(diagrams[best], choice=f"{NAMES[best]} rather than {NAMES[rest]}, whose BIC is {how}")


def _advantage(diagram: Stabilisation, taken: SelectedPoles, other: SelectedPoles) -> float:
    """BIC of the first choice of poles less that of the second, both with the noise of the better fit."""
    both = (taken, other)
    left = [weighted_residuals(diagram.lines, choice.poles, choice.participations, diagram.settings) for choice in both]
    criterion = BicCriterion(diagram.lines, min(left, key=lambda residual: float((abs(residual) ** 2).sum())))
    first, second = (criterion.value(rest, pole_count(choice.poles)) for rest, choice in zip(left, both, strict=True))
    return first - second
