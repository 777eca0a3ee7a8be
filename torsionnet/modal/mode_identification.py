"""Identification of modes from frequency responses by stabilisation diagram, choice of poles, and refinement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.notes import warning
from torsionnet.base.threads import one_thread
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.matrix_fraction import as_poles
from torsionnet.modal.modal_estimate import ModalEstimate, about_fit, estimate_from_expansion
from torsionnet.modal.refinement import fit_record, record_lines, refine
from torsionnet.modal.residues import expand
from torsionnet.modal.selection import CLOSE_MODES, SelectedPoles, Selection, merged, select, stabilisation
from torsionnet.modal.spectral_lines import ComplexArray, Lines, Settings, band_notes, lines_of
from torsionnet.modal.stabilisation_chart import Stabilisation

UNSETTLED = warning("the refinement did not settle; fewer poles or a narrower band may help")
"""Warning about poles whose least squares were not reached."""
UNPARTED = "lie so near to another that windows cannot part them, and are taken as one with it"
"""Words on merged poles in a note."""
LEAST_DECAY = 0.02
"""Decay rate times length of a record below which a pole is a steady vibration, which others than the input cause."""
METHODS = {"rational": "rational fraction", "lscf": "least-squares complex frequency"}
"""Name of each identification method in titles of results, by its key in the settings."""


@one_thread()
def identify_modes(
    measured: FrequencyResponse | Stabilisation,
    settings: Settings | None = None,
    *,
    selection: Selection | None = None,
    refined: bool = True,
) -> ModalEstimate:
    """Modes identified from transfer functions (natural frequencies, damping ratios, shapes at the sensors).

    The poles of a transfer function against a *measured* torque are those of the drivetrain cut at the transducer:
    compare them with ``drivetrain.modes(measured_input=...)``, not with ``drivetrain.modes()``.

    Parameters
    ----------
    measured : FrequencyResponse or Stabilisation
        Calculated or estimated; receptances, mobilities, accelerances, ratios of angles and the like. All its transfer
        functions are of one test and share their poles.
    settings : Settings, optional
        Left out where a diagram is given, which has its own.
    selection : "order", "clusters", int or sequence of (int, float), optional
        ``"order"``: all poles of the order with the least Schwarz criterion (BIC). ``"clusters"``: the poles that stay
        in frequency, damping and shape over ``criteria.least_orders`` orders in a row, within the band. A number: all
        poles of that order. By hand: order and frequency in Hz of each pole. By default ``"order"`` for the rational
        fraction and ``"clusters"`` for LSCF; with a selection of one's own ``auto`` is the rational fraction.
    refined : bool, optional
        Move the poles to the least squares of the responses themselves, and give standard errors. Left out, with a
        note, where several inputs have modes too close to each other for it.

    Raises
    ------
    UsageError
        Too few frequencies, channels that no modes are fitted to, an unknown order.
    SolveError
        No pole is stable, or no pole is chosen by the rule.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("amt_rig").configured("V_c_O_360")
    >>> test = rig.frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.1))
    >>> estimate = identify_modes(test)
    >>> estimate.kinds
    ('real pole', 'oscillatory')
    >>> estimate.notes[0]
    '1 pole outside the band of 0.5 to 29.9 Hz stands for what is beyond it and is not listed'
    >>> own = rig.modes(measured_input="T_T").eigenvalues[:2]
    >>> bool(np.allclose(estimate.poles, own, rtol=1e-6))
    True
    """
    diagram = measured if isinstance(measured, Stabilisation) else _diagram(measured, settings or Settings(), selection)
    rule: Selection = (
        ("order" if diagram.settings.method == "rational" else "clusters") if selection is None else selection
    )
    chosen = select(diagram, rule)
    whole = _fitted(diagram.response, diagram.lines, diagram.settings, chosen, refined=refined)
    estimate = whole.within_band() if chosen.automatic else whole
    seen = chosen.seen if len(chosen.seen) == len(whole) and not whole.by_record else ()
    seen = tuple(
        count for count, f in zip(seen, whole.natural_frequencies, strict=False) if f in estimate.natural_frequencies
    )
    where, why = ", fitted to the record", (f"method: {diagram.choice}",) if diagram.choice else ()
    title = ", ".join(
        [METHODS[diagram.settings.method], *([] if whole.by_record and chosen.automatic else [chosen.rule])]
    )
    about = about_fit(estimate, seen, len(diagram.orders))
    return replace(estimate, method=title + where * whole.by_record, notes=(*estimate.notes, *about, *why))


@one_thread()
def fit_poles(
    response: FrequencyResponse, poles: ArrayLike, settings: Settings | None = None, *, refined: bool = False
) -> ModalEstimate:
    """Modes with given poles (rad/s), whose shapes and residues are fitted to a response; poles only if ``refined``.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> response = rig.frequency_response("theta_1", "T_M", np.arange(0.5, 30, 0.1))
    >>> fit_poles(response, rig.modes().eigenvalues).misfit.max() < 1e-9
    np.True_
    """
    chosen = settings or Settings()
    given = as_poles(poles)
    selected = SelectedPoles(given, np.ones((len(given), len(response.inputs)), dtype=complex), (), "given poles")
    estimate = _fitted(response, lines_of(response, chosen), chosen, selected, refined=refined, free=True)
    return replace(estimate, method="given poles", notes=(*estimate.notes, *about_fit(estimate)))


def _diagram(response: FrequencyResponse, settings: Settings, selection: Selection | None) -> Stabilisation:
    by_hand = settings.method == "auto" and selection is not None
    return stabilisation(response, replace(settings, method="rational") if by_hand else settings)


def _fitted(
    response: FrequencyResponse,
    lines: Lines,
    settings: Settings,
    chosen: SelectedPoles,
    *,
    refined: bool,
    free: bool = False,
) -> ModalEstimate:
    poles, notes = chosen.poles, band_notes(response, settings.band)
    # Residues of close poles grow against each other if each is free: as shape times participation they do not.
    together = not free and lines.values.shape[2] > 1 and _any_close(poles)
    if together or not refined:
        close = ("modes lie close together: residues are shapes times participations; poles not refined",)
        expansion = expand(lines, poles, settings, chosen.participations if together else None)
        return estimate_from_expansion(response, lines, expansion, notes + close * together)
    record = record_lines(response, lines, poles, settings)
    seconds = np.inf
    if isinstance(record, Lines):
        fit = fit_record(record, poles, settings, automatic=chosen.automatic)
        estimate, better = estimate_from_expansion(response, lines, fit.expansion, notes), fit.refined
        estimate = replace(estimate, by_record=True, misfit=fit.misfit)
        seconds = 2 * np.pi / float(np.abs(record.s[1] - record.s[0]))  # lines lie 1 / seconds apart
    else:
        widened = response.coherence is not None or response.estimation is not None
        better = refine(lines, poles, settings)
        # Windows widen a peak, which two poles may share: those too close to part are fitted as one.
        while widened and chosen.automatic and len(fewer := merged(response, better.poles)) < len(better.poles):
            better = refine(lines, fewer, settings)
        if len(better.poles) < len(poles):
            notes += (f"{len(poles) - len(better.poles)} of {len(poles)} poles {UNPARTED}",)
        estimate = estimate_from_expansion(response, lines, expand(lines, better.poles, settings), notes)
        if widened:
            why = warning(f"no standard errors: {record}, and windows move poles by more than random errors do")
            return replace(estimate, notes=(*notes, why))
    if not better.converged:
        estimate = replace(estimate, notes=(*estimate.notes, UNSETTLED))
    estimate = replace(estimate, frequency_errors=better.frequency_errors, damping_errors=better.damping_errors)
    return _decaying(estimate, seconds) if chosen.automatic else estimate


def _decaying(estimate: ModalEstimate, seconds: float) -> ModalEstimate:
    """Estimate without poles that hardly decay within the seconds of its record, as steady vibrations are no modes."""
    # -Re(lambda) T is the logarithm by which a mode decays in T.
    steady = -estimate.poles.real * seconds < LEAST_DECAY
    if not steady.any():
        return estimate
    places = ", ".join(f"{f:.4g} Hz" for f in estimate.natural_frequencies[steady])
    note = f"no mode: a vibration at {places} that does not decay within the record, as the order of an engine"
    return replace(estimate.only(~steady), notes=(*estimate.notes, note))


def _any_close(poles: ComplexArray) -> bool:
    distance = np.abs(poles[:, None] - poles)
    limit = CLOSE_MODES * (np.abs(poles.real)[:, None] + np.abs(poles.real))
    np.fill_diagonal(distance, np.inf)
    return bool((distance < limit).any())
