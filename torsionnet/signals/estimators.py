"""Estimation of frequency responses from recordings (H1, H2, Hv, Hs, Hr)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

import torsionnet.signals.spectra as transfer_matrices
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import Note, warning
from torsionnet.linear.between_samples import course_remark
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.recording import FloatArray, Recording
from torsionnet.signals.resampling import Recordings, check_processable, decimate, stacked
from torsionnet.signals.spectra import ComplexArray, CrossSpectra, cross_spectra
from torsionnet.signals.uncertainty import (
    ResolutionWatch,
    averaging_data,
    peak_warnings,
    with_record,
    with_resolution_limit,
)
from torsionnet.signals.welch import Welch, aligned, lag_warnings

Estimator: TypeAlias = Literal["H1", "H2", "Hv", "Hs", "Hr"]
Names: TypeAlias = str | Sequence[str]
INSEPARABLE_EIGENVALUE = 0.01
"""Smallest eigenvalue of the normalised input spectra below which the effects of several inputs cannot be separated, 0
being proportional inputs."""
LEAST_DRIVEN = 0.2
"""Least share of an input's power that a signal must explain to be a reference for it, as otherwise noise drives the
estimate."""


def estimate(
    measured: Recordings | CrossSpectra,
    output: Names,
    input: Names,
    estimator: str | None = None,
    settings: Welch | None = None,
    noise_ratio: float | None = None,
    reference: Names = (),
    band: tuple[float, float] | None = None,
    *,
    align: bool = False,
) -> FrequencyResponse:
    """Frequency response with coherence estimated from a recording or from averaged spectra.

    Parameters
    ----------
    measured : Recording, iterable of Recording, or CrossSpectra
        As for :func:`~torsionnet.signals.spectra.cross_spectra`, or its result.
    output, input : str or sequence of str
        Names of signals. Several inputs must not be proportional to each other.
    estimator : {"H1", "H2", "Hv", "Hs", "Hr"}, optional
        ``H1`` for noise on the outputs, ``H2`` for noise on the inputs, ``Hs`` for noise on both in the proportion
        ``noise_ratio``. ``Hv`` is ``Hs`` with a noise ratio of 1, whose meaning depends on the units (SI here).
        ``Hr``, the one taken where there is a ``reference``, for noise on both of any size. By default that of the
        settings, or ``H1``.
    settings : Welch, optional
    noise_ratio : float, optional
        Of ``Hs``: spectral density of the output's noise over that of each input's noise, in the squared SI units.
        If left out, of one input, the two are taken to be equally noisy in proportion to their size: the
        geometric mean of H1 and H2, independent of units.
    reference : str or sequence of str, optional
        Of ``Hr``: signals that drive the inputs and share no noise with them, such as the set-point of the exciter;
        as many as there are inputs, or more.
    band : (float, float), optional
        Lowest and highest frequency in Hz that are kept and judged; all by default.
    align : bool
        Move the output to earlier times by its lag behind the input before windows cut both, of which they would lose a
        share, and put the phase of the lag back: the dead time of a plant remains in the response.

    Returns
    -------
    FrequencyResponse
        Its coherence is the ordinary one, of each output with each input alone. An input that is held or straight
        between samples, as its signal says, is taken as such; what folds back from above half the rate remains, which a
        fit allows for.

    Examples
    --------
    >>> from torsionnet.signals.recording import Recording, Signal
    >>> torque = np.random.default_rng(1).normal(size=5000)
    >>> record = Recording((Signal("T", "torque", torque), Signal("theta", "angle", 0.01 * torque)), 100)
    >>> response = estimate(record, "theta", "T")
    >>> response.unit(), round(float(response.magnitude.max()), 6), round(float(response.coherence.min()), 6)
    ('rad/(N*m)', 0.01, 1.0)
    """
    outputs, inputs, references = _listed(output), _listed(input), _listed(reference)
    if align:
        if not isinstance(measured, Recording) or len(outputs) != 1 or len(inputs) != 1:
            raise UsageError(
                "signals are aligned in one record in memory, an output and an input at a time", kind="wrong-form"
            )
        moved, lag = aligned(measured.select(dict.fromkeys((*outputs, *inputs, *references))), outputs[0], inputs[0])
        of_moved = estimate(moved, outputs, inputs, estimator, settings, noise_ratio, references, band)
        if not lag:
            return replace(of_moved, notes=(*of_moved.notes, f"no clear lag of {outputs[0]}: nothing is moved"))
        # The output was moved earlier by the lag; exp(-j omega lag) puts it back.
        turned = of_moved.values * np.exp(-2j * np.pi * of_moved.frequencies * lag)[:, None, None]
        moves = f"{1e3 * abs(lag):g} ms {'earlier' if lag > 0 else 'later'}"
        note = f"{outputs[0]} {moves} where windows cut the record; the phase of the lag is put back"
        # The record, which has the lag, would contradict a response without its loss.
        kept = None if of_moved.estimation is None else replace(of_moved.estimation, record=None, aligned=lag)
        return replace(of_moved, values=turned, notes=(*of_moved.notes, note), estimation=kept)
    watch = ResolutionWatch(outputs, inputs[0], (settings or Welch()).seconds) if inputs else None
    spectra, records = _spectra(measured, (*outputs, *inputs, *references), settings, watch)
    asked = estimator or ("Hr" if references else spectra.settings.estimator) or "H1"
    chosen = _require_estimable(asked, outputs, inputs, references, noise_ratio)
    s_xx, s_xy = spectra.between(inputs, inputs), spectra.between(inputs, outputs)
    s_yy = spectra.between(outputs, outputs)
    if chosen == "Hr":
        values = transfer_matrices.hr(spectra.between(references, inputs), spectra.between(references, outputs))
    else:
        values = _values(chosen, s_xx, s_xy, s_yy, noise_ratio)
    driving = [spectra.channels[i] for i in spectra.indices(inputs)]
    # The vibration of a torque that is held or straight is less than that of its samples.
    shares = np.stack([channel.course.share(spectra.frequencies) for channel in driving if channel.course], axis=1)
    response = FrequencyResponse(
        frequencies=spectra.frequencies,
        values=values / shares[:, None, :],
        outputs=tuple(spectra.channels[i] for i in spectra.indices(outputs)),
        inputs=tuple(driving),
        title=spectra.title,
        coherence=transfer_matrices.ordinary_coherence(s_xx, s_xy, s_yy),
        notes=(*spectra.notes, _provenance(chosen, spectra, noise_ratio, references)),
        estimation=replace(_origin(chosen, spectra, outputs, inputs, records), references=references),
    )
    low, high = band or (0.0, np.inf)
    response = with_resolution_limit(response, watch, spectra.settings.decimation, high) if watch else response
    response = response.between(low, high)
    peaks = peak_warnings(response, 1 / spectra.settings.seconds, judge_coherence=len(inputs) == 1)
    inside = (spectra.frequencies >= low) & (spectra.frequencies <= high)
    warnings = (*_spectra_warnings(spectra, s_xx, inside), *_reference_warnings(spectra, inputs, references))
    top = float(response.frequencies[-1]) if len(response.frequencies) else 0.0
    courses = [
        (channel.name, channel.course) for channel in driving if channel.course and not channel.course.is_band_limited
    ]
    remarks = filter(None, (course_remark(*pair, top) for pair in courses))
    lags = lag_warnings(records[1], outputs, inputs[0], spectra.settings) if records and len(inputs) == 1 else []
    return replace(response, notes=(*response.notes, *remarks, *lags, *warnings, *peaks))


def multiple_coherence(spectra: CrossSpectra, output: Names, input: Names) -> FloatArray:
    """Multiple coherence, the share of each output's power that is linear in all inputs together, (n_f, n_out)."""
    outputs, inputs = _listed(output), _listed(input)
    return transfer_matrices.multiple_coherence(
        spectra.between(inputs, inputs), spectra.between(inputs, outputs), spectra.between(outputs, outputs)
    )


def _listed(names: Names) -> tuple[str, ...]:
    return (names,) if isinstance(names, str) else tuple(names)


def _spectra(
    measured: Recordings | CrossSpectra, names: tuple[str, ...], settings: Welch | None, watch: ResolutionWatch | None
) -> tuple[CrossSpectra, tuple[Recording, Recording] | None]:
    """Averaged cross spectra, and for a record in memory its signals before and after decimation."""
    wanted, used = dict.fromkeys(names), settings or Welch()
    if isinstance(measured, Recording):
        fine = measured.select(wanted)
        for _ in watch.collecting([fine]) if watch else ():
            pass
        coarse = decimate(fine, used.decimation) if used.decimation > 1 else fine
        return replace(cross_spectra(coarse, replace(used, decimation=1)), settings=used), (fine, coarse)
    if not isinstance(measured, CrossSpectra):
        chosen = (block.select(wanted) for block in measured)
        return cross_spectra(watch.collecting(chosen) if watch else chosen, used), None
    if settings is not None:
        raise UsageError(
            "spectra are averaged already; settings can only be given for a recording", kind="needless-entry"
        )
    return measured, None


def _origin(
    estimator: str,
    spectra: CrossSpectra,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    records: tuple[Recording, Recording] | None,
) -> Estimation:
    estimation = averaging_data(estimator, spectra)
    return with_record(estimation, outputs, inputs[0], *records) if records and len(inputs) == 1 else estimation


def _require_estimable(
    estimator: str,
    outputs: Sequence[str],
    inputs: Sequence[str],
    references: Sequence[str],
    noise_ratio: float | None,
) -> str:
    known = get_args(Estimator)
    if estimator not in known:
        raise UsageError(
            f'no estimator is named "{estimator}"{did_you_mean(estimator, known)}; there is {", ".join(known)}',
            kind="unknown-word",
        )
    if estimator == "H2" and 1 < len(inputs) > len(outputs):
        counts = f"there are {len(outputs)} and {len(inputs)}"
        raise UsageError(f"H2 needs as many outputs as inputs; {counts}: add outputs, or take H1", kind="wrong-count")
    if estimator == "Hs" and noise_ratio is None and len(inputs) > 1:
        raise UsageError(
            "Hs of several inputs needs a noise ratio, that of output noise to input noise: noise_ratio=...",
            kind="missing-entry",
        )
    if noise_ratio is not None and (estimator != "Hs" or not noise_ratio > 0):
        raise UsageError(
            f"a noise ratio is a positive number and belongs to Hs, got {noise_ratio} for {estimator}",
            kind="out-of-range",
        )
    if estimator == "Hr" and len(references) < len(inputs):
        raise UsageError(
            f"Hr needs a reference for each input, such as the set-point: {len(references)} for {len(inputs)}",
            kind="wrong-count",
        )
    if references and estimator != "Hr":
        raise UsageError(
            f"a reference belongs to Hr; {estimator} has no use for {', '.join(references)}", kind="needless-entry"
        )
    return estimator


def _values(
    estimator: str, s_xx: ComplexArray, s_xy: ComplexArray, s_yy: ComplexArray, noise_ratio: float | None
) -> ComplexArray:
    if estimator == "H1":
        return transfer_matrices.h1(s_xx, s_xy)
    if estimator == "H2":
        return transfer_matrices.h2(s_yy, s_xy.conj().transpose(0, 2, 1))
    if estimator == "Hv":
        return transfer_matrices.hs(s_xx, s_xy, s_yy, 1.0)
    if noise_ratio is not None:
        return transfer_matrices.hs(s_xx, s_xy, s_yy, noise_ratio)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Equal ratios of signal to noise on both sides: noise in proportion to the signals, S_yy/S_xx.
        alike = np.einsum("foo->fo", s_yy).real / s_xx[:, :, 0].real
    return transfer_matrices.hs(s_xx, s_xy, s_yy, alike)


def _provenance(estimator: str, spectra: CrossSpectra, noise_ratio: float | None, references: Sequence[str]) -> str:
    ratio = "" if noise_ratio is None else f" with noise ratio {noise_ratio:g}"
    ratio += f" with {', '.join(references)} as reference" if references else ""
    count = f"{spectra.averages} averages worth {spectra.effective_averages:.1f} without overlap"
    return f"{estimator}{ratio}, {spectra.settings}, {count}"


def _spectra_warnings(spectra: CrossSpectra, s_xx: ComplexArray, asked: NDArray[np.bool_]) -> list[Note]:
    remarks = []
    if spectra.averages == 1:
        remarks.append(warning("of one segment the coherence is 1 whatever the signals; use a longer record"))
    inseparable = spectra.frequencies[asked & (transfer_matrices.independence(s_xx) < INSEPARABLE_EIGENVALUE)]
    if s_xx.shape[1] > 1 and len(inseparable):
        span = f"{len(inseparable)} frequencies from {inseparable[0]:g} to {inseparable[-1]:g} Hz"
        remarks.append(
            warning(f"the inputs are all but proportional at {span}; their effects cannot be told apart there")
        )
    return remarks


def _reference_warnings(spectra: CrossSpectra, inputs: Sequence[str], references: Sequence[str]) -> list[Note]:
    if not references:
        return []
    shares = np.nanmedian(multiple_coherence(spectra, inputs, references), axis=0)
    names = " and ".join(references)
    return [
        warning(f"{names} explains {100 * share:.2g} % of {name}: hardly what drives it; take another reference")
        for name, share in zip(inputs, shares, strict=True)
        if share < LEAST_DRIVEN
    ]


# Estimation of frequency responses without averaging, from a stepped sine or the spectrum of a whole record.


@dataclass(frozen=True)
class Step:
    """Step of a stepped sine, with its frequency in Hz and its start and end in s."""

    frequency: float
    start: float
    end: float


def stepped_sine(
    recording: Recording, output: Names, input: str, steps: Iterable[Step], settling: float = 0.0
) -> FrequencyResponse:
    """Frequency response at the steps of a stepped sine, from sines fitted to the signals by least squares.

    Mean and slope of each signal are fitted too. Only whole periods at the end of each step are used.

    Parameters
    ----------
    recording : Recording
    output : str or sequence of str
    input : str
    steps : iterable of Step
    settling : float, optional
        Time in s left out at the start of every step, for the transient to decay.

    Raises
    ------
    UsageError
        A step has no whole period within the record.
    """
    outputs = (output,) if isinstance(output, str) else tuple(output)
    chosen, ordered = _checked(recording, (*outputs, input)), sorted(steps, key=lambda step: step.frequency)
    sines = np.array([_sines(chosen, step, settling) for step in ordered])
    note = f"stepped sine of {len(ordered)} steps, {settling:g} s each left to settle"
    return _response(chosen, np.array([step.frequency for step in ordered]), sines, note)


def _checked(recording: Recording, names: Sequence[str]) -> Recording:
    chosen = recording.select(names)
    check_processable(chosen)
    return chosen


def _sines(recording: Recording, step: Step, settling: float) -> ComplexArray:
    """Complex amplitude of every signal in one step of a stepped sine, by least squares, (n_signals,)."""
    rate, begin = recording.sampling_rate, step.start + settling
    last = min(round((step.end - recording.start) * rate), len(recording))
    periods = int((last / rate - (begin - recording.start)) * step.frequency + 1e-9)
    if periods < 1 or begin < recording.start:
        raise UsageError(
            f"the step at {step.frequency:g} Hz has no whole period in the record after settling; hold it longer",
            kind="too-short",
        )
    first = last - round(periods / step.frequency * rate)
    time = recording.time[first:last]
    angle = 2 * np.pi * step.frequency * time
    # a cos + b sin over whole periods is Re (a - j b) exp(j omega t); mean and drift are fitted beside it.
    basis = np.array([np.cos(angle), np.sin(angle), np.ones_like(time), np.linspace(-1, 1, len(time))]).T
    fit = np.linalg.lstsq(basis, stacked(recording)[:, first:last].T, rcond=None)[0]
    return np.asarray(fit[0] - 1j * fit[1], dtype=np.complex128)


def _response(recording: Recording, frequencies: FloatArray, lines: ComplexArray, note: str) -> FrequencyResponse:
    courses = (signal.course(recording.sampling_rate) for signal in recording)
    *outputs, into = (
        Channel(signal.name, signal.unit, course) for signal, course in zip(recording, courses, strict=True)
    )
    assert into.course is not None
    driven = lines[:, -1] * into.course.share(frequencies)
    remark = "" if into.course.is_band_limited else course_remark(into.name, into.course, float(frequencies.max()))
    return FrequencyResponse(
        frequencies=frequencies,
        values=np.asarray(lines[:, :-1, None] / driven[:, None, None], dtype=np.complex128),
        outputs=tuple(outputs),
        inputs=(into,),
        title=recording.title,
        notes=(*recording.notes, note, *filter(None, [remark])),
    )
