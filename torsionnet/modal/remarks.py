"""Warnings about identified modes that are outside the band, uncertain, computational, too narrow or badly fitted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.notes import NoteOrText, warning
from torsionnet.modal.spectral_lines import FloatArray

if TYPE_CHECKING:
    from torsionnet.modal.modal_estimate import ModalEstimate

FEWEST_PEAK_LINES = 3
"""Number of lines within a half-power bandwidth below which a warning is given, as a window may have widened the
peak."""
FAR_OUTSIDE_BAND = 2.0
"""Ratio of a natural frequency to an end of the band beyond which a pole stands for residual terms, not for a mode."""
LARGEST_MISFIT = 0.1
"""RMS residual of a fit of modes over RMS of the response above which a warning is given, as modes may be missing."""
LARGEST_ERROR = 0.1
"""Standard error over its value above which a warning calls a natural frequency or damping ratio uncertain."""
FEWEST_ORDERS = 2
"""Fewest orders of a stabilisation diagram at which a pole must be found, as fewer may be a computational pole."""


def about_fit(estimate: ModalEstimate, seen: Sequence[int] = (), orders: int = 0) -> tuple[NoteOrText, ...]:
    """Warnings about modes outside the band, uncertain, computational or narrow, and about a large misfit of a fit."""
    narrow = () if estimate.by_record else _narrow(estimate)
    found = [*_beyond(estimate), *_uncertain(estimate), *_rare(estimate, seen, orders), *narrow]
    worst = float(np.max(estimate.misfit))
    if worst > LARGEST_MISFIT:
        found.append(warning(f"the fit leaves {worst:.0%} of a response over; more orders or another band may help"))
    return tuple(found)


def line_spacing(frequencies: FloatArray, near: float) -> float:
    """Spacing in Hz of the two lines of a response around a frequency in Hz."""
    if len(frequencies) < 2:
        return float("nan")
    place = int(np.clip(np.searchsorted(frequencies, near), 1, len(frequencies) - 1))
    return float(frequencies[place] - frequencies[place - 1])


def _places(estimate: ModalEstimate, chosen: Sequence[int]) -> str:
    names = [
        f"{estimate.natural_frequencies[mode]:.4g} Hz" + ("" if estimate.poles[mode].imag else " (real pole)")
        for mode in chosen
    ]
    return ", ".join(names)


def _beyond(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    low, high = estimate.frequencies[[0, -1]]
    count = len(estimate.outside_poles)
    if count:
        yield (
            f"{count} pole{'s' * (count > 1)} outside the band of {low:g} to {high:g} Hz "
            f"stand{'s' * (count == 1)} for what is beyond it and {'are' if count > 1 else 'is'} not listed"
        )
    f = estimate.natural_frequencies
    outside = [
        mode for mode in range(len(estimate)) if not low / FAR_OUTSIDE_BAND <= f[mode] <= high * FAR_OUTSIDE_BAND
    ]
    if outside:
        yield (
            warning(
                f"far outside the band of {low:g} to {high:g} Hz: {_places(estimate, outside)}; it stands for "
                "what is beyond the band rather than for a mode"
            )
        )


def _uncertain(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    f, z = estimate.natural_frequencies, estimate.damping_ratios
    large = (estimate.frequency_errors > LARGEST_ERROR * f) | (estimate.damping_errors > LARGEST_ERROR * z)
    if large.any():
        yield warning(f"standard error above {LARGEST_ERROR:.0%} at {_places(estimate, list(np.flatnonzero(large)))}")


def _rare(estimate: ModalEstimate, seen: Sequence[int], orders: int) -> Iterator[NoteOrText]:
    rare = [mode for mode, count in enumerate(seen) if count < FEWEST_ORDERS] if len(seen) == len(estimate) else []
    if rare and orders > FEWEST_ORDERS:
        yield warning(f"seen at one order of {orders} only, perhaps computational: {_places(estimate, rare)}")


def _narrow(estimate: ModalEstimate) -> Iterator[NoteOrText]:
    narrow = [
        mode
        for mode, pole in enumerate(estimate.poles)
        if pole.imag
        and -pole.real / np.pi
        < FEWEST_PEAK_LINES * line_spacing(estimate.frequencies, estimate.natural_frequencies[mode])
    ]
    if narrow:
        yield (
            warning(
                f"half-power bandwidth under {FEWEST_PEAK_LINES} lines at {_places(estimate, narrow)}: if a "
                "window was used, its damping reads high; use longer segments"
            )
        )
