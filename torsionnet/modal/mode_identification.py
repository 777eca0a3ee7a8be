"""Identification of modes from frequency responses, by stabilisation diagram and refinement, or from their peaks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import SolveError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.threads import one_thread
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.matrix_fraction import Stabilisation, as_poles
from torsionnet.modal.modal_estimate import (
    FEWEST_PEAK_LINES,
    ModalEstimate,
    about_fit,
    estimate_from_expansion,
    line_spacing,
)
from torsionnet.modal.refinement import fit_record, record_lines, refine
from torsionnet.modal.residues import Expansion, expand
from torsionnet.modal.selection import CLOSE_MODES, SelectedPoles, Selection, merged, select, stabilisation
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines, Settings, band_notes, lines_of

# Identification of modes from frequency responses by stabilisation diagram, choice of poles, and refinement.

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


# Peak picking, which reads natural frequency, damping ratio and residue of each mode from its peak.

HALF_POWER_DAMPING_LIMIT = 0.10
"""Damping ratio up to which the half-power width gives it right, and above which a warning is given."""
LARGEST_ASYMMETRY = 1.25
"""Ratio of the halves of a half-power width, over that of one mode alone, above which neighbouring modes are assumed,
as distant ones make less.

A smaller value warns of the slopes of distant modes, too.
"""
MOST_DAMPED = 0.3826
"""Damping ratio from which on a receptance no longer falls to half power below its peak, by the formula for one
mode."""
SECOND_PEAK_RISE = 1.1
"""Magnitude over the lowest on the way down from a peak above which there is a second peak, as less may be noise."""


@dataclass(frozen=True)
class PickedPeak:
    """Peak of a magnitude curve, with its frequency and half-power points in Hz.

    Attributes
    ----------
    line : int
        Index of the highest line.
    frequency : float
        Frequency of the peak, interpolated between lines, Hz.
    edges : (float, float)
        Frequencies of the half-power points in Hz; nan where the curve does not fall so far.
    shared : bool
        Whether the curve rises again before it has fallen to half power.
    """

    line: int
    frequency: float
    edges: tuple[float, float]
    shared: bool

    @property
    def damping_ratio(self) -> float:
        """Damping ratio from the half-power width of the peak, or from one half of it where only one is there."""
        low, high = self.frequency - self.edges[0], self.edges[1] - self.frequency
        if np.isnan(low) or np.isnan(high):
            return float((high if np.isnan(low) else low) / self.frequency)
        return float((low + high) / (2 * self.frequency))


def peak_picking(
    response: FrequencyResponse, *, band: tuple[float, float] | None = None, prominence: float = 3.0
) -> ModalEstimate:
    """Modes by peak picking, natural frequencies from peaks and damping ratios from their half-power widths.

    Good for light damping and modes far apart; remarks say where a peak is neither. Several transfer functions are
    read from one curve, the root mean square of all of them, each divided by its own.

    Parameters
    ----------
    response : FrequencyResponse
        Peaks are taken in the quantity measured: an accelerance's lie above a receptance's where damping is strong.
    band : (float, float), optional
        Hz.
    prominence : float, optional
        Decibels by which a peak must stand out.

    Returns
    -------
    ModalEstimate
        Residues are fitted to each mode alone at its peak, without residual terms.

    Raises
    ------
    SolveError
        No peak stands out, or none falls to half power on either side.

    Examples
    --------
    >>> import torsionnet as tn
    >>> test = tn.load("dmf_rig").frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.05))
    >>> read = peak_picking(test)
    >>> read.natural_frequencies.round(2).tolist(), read.damping_ratios.round(3).tolist()
    ([8.12], [0.306])
    >>> print(read.notes[0])
    warning: 30.6 % at 8.116 Hz is too damped for half power, which reads right up to some 10 %: fit the modes instead
    """
    lines = lines_of(response, Settings(band=band))
    frequencies = np.abs(lines.s) / (2 * np.pi)
    curve = mean_magnitude(lines)
    peaks = [_read(frequencies, curve, line) for line in _highest(curve, prominence)]
    if not peaks:
        raise SolveError(
            f"no peak stands out by {prominence:g} dB; give a lower prominence, or fit the modes", kind="no-resonance"
        )
    # NaN where the curve falls to half power on neither side.
    good = [peak for peak in peaks if 0 < peak.damping_ratio < 1]
    if not good:
        raise SolveError(
            "no peak falls to half power within the band, so that no damping can be read; fit the modes instead",
            kind="no-resonance",
        )
    lost = [peak for peak in peaks if peak not in good]
    notes: tuple[NoteOrText, ...] = band_notes(response, band)
    notes += tuple(remark for peak in good for remark in _remarks(peak, frequencies))
    notes += tuple(warning(f"the peak at {peak.frequency:.4g} Hz has no half-power points; left out") for peak in lost)
    return estimate_from_expansion(
        response, lines, _one_by_one(lines, good), notes, method="peak picking with half power"
    )


def mean_magnitude(lines: Lines) -> FloatArray:
    """RMS over all transfer functions at each line, (n_f,), each divided by its own RMS over the lines."""
    return np.asarray(np.sqrt(np.mean(np.abs(lines.values * lines.balance) ** 2, axis=(1, 2))))


def _highest(curve: FloatArray, prominence: float) -> list[int]:
    from scipy.signal import find_peaks

    level = 20 * np.log10(np.maximum(curve, 1e-10 * curve.max()))
    return [int(line) for line in find_peaks(level, prominence=prominence)[0]]


def _read(frequencies: FloatArray, curve: FloatArray, line: int) -> PickedPeak:
    level = curve[line] / np.sqrt(2)
    low, shared_low = _edge(frequencies[line::-1], curve[line::-1], level)
    high, shared_high = _edge(frequencies[line:], curve[line:], level)
    return PickedPeak(line, _summit(frequencies, curve, line), (low, high), shared_low or shared_high)


def _edge(frequencies: FloatArray, curve: FloatArray, level: float) -> tuple[float, bool]:
    """Frequency in Hz at which a curve falls from a peak to a level, nan if never, and whether it rises on the way."""
    below = np.flatnonzero(curve < level)
    end = int(below[0]) if len(below) else len(curve) - 1
    lowest = np.minimum.accumulate(curve[: end + 1])
    shared = bool((curve[: end + 1] > SECOND_PEAK_RISE * lowest).any())
    if not len(below):
        return float("nan"), shared
    pair = [end, end - 1]
    return float(np.interp(level, curve[pair], frequencies[pair])), shared


def _summit(frequencies: FloatArray, curve: FloatArray, line: int) -> float:
    """Frequency of a peak in Hz between lines, from the parabola through the inverse squared magnitudes."""
    # Near the peak of a mode 1/|H|^2 is nearly a parabola, |H| is not.
    f, y = frequencies[line - 1 : line + 2], curve[line - 1 : line + 2] ** -2
    a, b = f - f[1], y - y[1]
    # Divided differences, as lines may be unevenly apart.
    bend = (b[2] / a[2] - b[0] / a[0]) / (a[2] - a[0])
    if not bend > 0:
        return float(f[1])
    slope = b[2] / a[2] - bend * a[2]
    return float(np.clip(f[1] - slope / (2 * bend), f[0], f[2]))


def _remarks(peak: PickedPeak, frequencies: FloatArray) -> Iterator[NoteOrText]:
    f, zeta = peak.frequency, peak.damping_ratio
    if zeta > HALF_POWER_DAMPING_LIMIT:
        yield (
            warning(
                f"{100 * zeta:.1f} % at {f:.4g} Hz is too damped for half power, which reads right up to some "
                f"{100 * HALF_POWER_DAMPING_LIMIT:g} %: fit the modes instead"
            )
        )
    if np.isnan(peak.edges).any():
        side = "below" if np.isnan(peak.edges[0]) else "above"
        yield warning(f"the peak at {f:.4g} Hz has no half-power point {side} it; damping is read from the other side")
        return
    width, spacing = peak.edges[1] - peak.edges[0], line_spacing(frequencies, f)
    if width < FEWEST_PEAK_LINES * spacing:
        yield (
            warning(
                f"half-power bandwidth of {width:.3g} Hz at {f:.4g} Hz is under {FEWEST_PEAK_LINES} lines of "
                f"{spacing:.3g} Hz: its damping reads high; use longer segments"
            )
        )
    elif peak.shared or _is_asymmetric(peak):
        yield warning(f"the peak at {f:.4g} Hz is not that of one mode alone: neighbours falsify its damping")


def _is_asymmetric(peak: PickedPeak) -> bool:
    """Whether the halves of a peak's half-power width are more unequal than those of a single mode."""
    from scipy.optimize import brentq

    width = (peak.edges[1] - peak.edges[0]) / peak.frequency

    def wider(zeta: float) -> float:
        low, high = _halves(zeta)
        return low + high - width

    if wider(MOST_DAMPED) < 0:
        return True
    # Damping ratio with that whole width, and the halves that its receptance has.
    low, high = _halves(brentq(wider, 0.0, MOST_DAMPED))
    ratio = (peak.frequency - peak.edges[0]) / (peak.edges[1] - peak.frequency) * high / low
    return not 1 / LARGEST_ASYMMETRY < ratio < LARGEST_ASYMMETRY


def _halves(zeta: float) -> tuple[float, float]:
    """Distances of the half-power points of a receptance from its peak, over the peak's frequency (below, above)."""
    # (omega/omega_n)^2 = 1 - 2 zeta^2 at the peak, and +- 2 zeta sqrt(1 - zeta^2) from there half the power.
    top, half = 1 - 2 * zeta**2, 2 * zeta * math.sqrt(1 - zeta**2)
    return 1 - math.sqrt(max(1 - half / top, 0)), math.sqrt(1 + half / top) - 1


def _one_by_one(lines: Lines, peaks: list[PickedPeak]) -> Expansion:
    omega = 2 * np.pi * np.array([peak.frequency for peak in peaks])
    zeta = np.array([peak.damping_ratio for peak in peaks])
    poles = omega * (-zeta + 1j * np.sqrt(1 - zeta**2))
    places = [peak.line for peak in peaks]
    s = lines.s[places][:, None, None]
    # At its peak a mode alone is H = s^p R/(s - lambda), without its conjugate, which is far off.
    residues = lines.values[places] / s**lines.powers * (s - poles[:, None, None])
    nothing = np.zeros(lines.powers.shape)
    return Expansion(poles, residues, nothing, nothing)
