"""What the page shows in one state: the response, the modes, the parameters, how far a test is from the model."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from torsionnet.core.errors import ModelError, TorsionnetError, TorsionnetWarning
from torsionnet.drivetrain import Drivetrain
from torsionnet.explore.command_text import command_text
from torsionnet.explore.over_speed import over_speed
from torsionnet.explore.overlay import misfit
from torsionnet.explore.page_numbers import SHOWN, numbers
from torsionnet.explore.session import Session
from torsionnet.explore.sliders import sliders
from torsionnet.explore.state import State
from torsionnet.response import FrequencyResponse, Modes
from torsionnet.response.frequency_response import ORDERS, FloatArray
from torsionnet.response.phase import unwrapped
from torsionnet.solve.responses.grid import Adaptive, vibration_range

MOST_MODES, LARGE = 40, 120
"""Of more nodes than ``LARGE`` only the lowest modes are looked for: all of them would take longer than a drag."""
MOST_PEAKS = 6


POINTS, PER_PEAK, LEAST_PER_PEAK = 300, 41, 9
MOST_AT_PEAKS = 1600
"""Of many modes each gets fewer points: a screen has no more columns."""
UNDAMPED = 1e-7
"""Damping ratio below which a peak is as high as one cares to look closely."""
NEAREST = 2e-4
"""Share of its frequency to which an undamped peak is approached: it is drawn some thousand times its flanks."""
APPROACH = 4.0 ** np.arange(1, 5) / 2


def answer(session: Session, state: State) -> dict[str, Any]:
    """Everything that changes with the state, as JSON holds it; what is impossible, in words under ``refused``."""
    with noted() as notes:
        try:
            return _answer(session, state) | {"notes": notes}
        except TorsionnetError as error:
            return {"refused": reasons(error)}


@contextmanager
def noted() -> Iterator[list[str]]:
    """Warnings of the library as texts for the page instead of lines in the terminal."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", TorsionnetWarning)
        yield notes
    notes += dict.fromkeys(str(one.message) for one in found if issubclass(one.category, TorsionnetWarning))


def reasons(error: TorsionnetError) -> list[str]:
    """Every fault, with the entry of the model it is about."""
    if not isinstance(error, ModelError):
        return [str(error)]
    return [f"{_where(fault.path)}{fault.text}" for fault in error.faults]


def _where(path: tuple[str | int, ...]) -> str:
    return f"{' '.join(map(str, path[1:]))}: " if len(path) > 1 else ""


def _answer(session: Session, state: State) -> dict[str, Any]:
    plain, rig = session.chosen(state.choice), session.varied(state)
    shown = session.completed(state)
    modes = _modes(rig)
    return {
        "title": rig.title,
        "excitation": shown.excitation,
        "parameters": [slider.to_data() for slider in sliders(plain, rig, state.values)],
        "modes": modes_data(modes),
        "cut": None,
        "findings": [fault.text for fault in rig.check() if fault.severity == "warning"],
        "command": command_text(session, shown),
        **(_over_speed(rig, shown) if state.axis == "speed" else _over_frequency(session, rig, shown, modes)),
    }


def _over_frequency(session: Session, rig: Drivetrain, shown: State, modes: Modes) -> dict[str, Any]:
    measured = _measured(rig, shown)
    found = [modes, measured] if measured else [modes]
    band = shown.band if any(shown.band) else vibration_range(*found)
    response = respond(rig, shown, lines(band, *found))
    return {
        "band": list(band),
        "response": response_data(response, _undamped(*found)),
        "cut": modes_data(measured) if measured else None,
        "misfit": misfit(session.overlay, shown, lambda f: respond(rig, shown, f), band),
    }


def _over_speed(rig: Drivetrain, shown: State) -> dict[str, Any]:
    return {"orders": over_speed(rig, shown.output, rough=shown.rough)}


def _modes(rig: Drivetrain) -> Modes:
    return rig.modes(lowest=MOST_MODES) if len(rig.nodes) > LARGE else rig.modes()


def _measured(rig: Drivetrain, state: State) -> Modes | None:
    """The poles of the response where its input is measured: those of the drivetrain cut there."""
    if not state.excitation:
        return None
    lowest = MOST_MODES if len(rig.nodes) > LARGE else None
    return rig.modes(measured_input=state.input, excitation=state.excitation, lowest=lowest)


def respond(rig: Drivetrain, state: State, frequencies: FloatArray) -> FrequencyResponse:
    """The response of one completed state."""
    response = rig.frequency_response(state.output, state.input, frequencies, excitation=state.excitation or None)
    is_motion = response.outputs[0].unit in ORDERS
    return getattr(response, state.quantity)() if state.quantity and is_motion else response


def response_data(response: FrequencyResponse, unbounded: FloatArray) -> dict[str, Any]:
    """Magnitude in SI and continuous phase in degrees, with what it takes to show them in other units.

    ``unbounded`` are frequencies in Hz at which a peak has no height.
    """
    values = response.values[:, 0, 0]
    magnitude, phase = np.abs(values), unwrapped(values)
    return {
        "label": f"{response.outputs[0].name}/{response.inputs[0].name}",
        "kind": response.kind(),
        "is_motion": response.outputs[0].unit in ORDERS,
        "units": {angle: response.unit(conventions=shown) for angle, shown in SHOWN.items()},
        "scales": {angle: response.scale(shown) for angle, shown in SHOWN.items()},
        "frequencies": numbers(response.frequencies),
        "magnitude": numbers(magnitude),
        "phase": numbers(phase),
        "peaks": _peaks(response.frequencies, magnitude, phase, unbounded),
        "notes": list(response.notes),
    }


def _peaks(
    frequencies: FloatArray, magnitude: FloatArray, phase: FloatArray, unbounded: FloatArray
) -> list[list[float | None]]:
    """[Hz, magnitude, degrees] of the largest local maxima, in the order of frequency; None where it has no height."""
    inner = magnitude[1:-1]
    with np.errstate(invalid="ignore"):
        at = 1 + np.flatnonzero((inner > magnitude[:-2]) & (inner >= magnitude[2:]) & np.isfinite(inner))
    largest = np.sort(at[np.argsort(-magnitude[at])][:MOST_PEAKS])
    near = [unbounded[np.abs(unbounded - frequencies[k]) < 4 * NEAREST * unbounded] for k in largest]
    return [
        [float(pole[0]), None, None] if pole.size else [float(frequencies[k]), float(magnitude[k]), float(phase[k])]
        for k, pole in zip(largest, near, strict=True)
    ]


def modes_data(modes: Modes) -> dict[str, Any]:
    """A table of modes by columns; lambda in rad/s."""
    return {
        "title": modes.title,
        "natural": numbers(modes.natural_frequencies),
        "damped": numbers(modes.damped_frequencies),
        "ratio": numbers(modes.damping_ratios),
        "real": numbers(modes.eigenvalues.real),
        "imag": numbers(modes.eigenvalues.imag),
        "numbers": list(modes.numbers),
        "kinds": list(modes.kinds),
        "descriptions": list(modes.descriptions),
        "notes": list(modes.notes),
    }


def lines(band: tuple[float, float], *modes: Modes) -> FloatArray:
    """Frequencies in Hz for the modes of a response, ascending.

    Examples
    --------
    >>> import torsionnet as tn
    >>> f = lines((0.5, 200.0), tn.load("dmf_rig").modes())
    >>> float(f[0]), float(f[-1]), 300 < len(f) < 400
    (0.5, 200.0, True)
    """
    vibrations = sum(int(np.sum(mode.damped_frequencies > 0)) for mode in modes)
    per_peak = min(PER_PEAK, max(LEAST_PER_PEAK, MOST_AT_PEAKS // max(1, vibrations)))
    f = Adaptive(*band, points=POINTS, per_peak=per_peak).frequencies(*modes)
    for pole in _undamped(*modes):
        f = f[np.abs(f - pole) > NEAREST * pole]
        f = np.union1d(f, np.outer(pole, 1 + np.outer((-1, 1), NEAREST * APPROACH)))
    return f[(f >= band[0]) & (f <= band[1])]


def _undamped(*modes: Modes) -> FloatArray:
    """Frequencies in Hz of vibrations without damping; several at one frequency count once."""
    found = [
        mode.damped_frequencies[(mode.damped_frequencies > 0) & (mode.damping_ratios < UNDAMPED)] for mode in modes
    ]
    every = np.sort(np.concatenate([np.empty(0), *found]))
    return every[np.diff(every, prepend=0.0) > NEAREST * every]
