"""Answer to one state of the explore page: response, modes, parameters and misfit of a test, as JSON data."""

from __future__ import annotations

import os
import shlex
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from torsionnet.app.explore.over_speed import CONVENTIONS_BY_ANGLE, json_numbers, misfit, over_speed
from torsionnet.app.explore.session import MANY_NODES, MOST_MODES, Session
from torsionnet.app.explore.sliders import point_sliders, sliders
from torsionnet.app.explore.state import State
from torsionnet.base.equal_remarks import collected_warnings
from torsionnet.base.errors import ModelError, TorsionnetError, warn_user
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import DERIVATIVE_ORDERS, FloatArray, FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.phase import unwrapped_phase
from torsionnet.linear.responses.grid import Adaptive, vibration_range
from torsionnet.model.configurations import label

# Motion of every node in each mode of a drivetrain, for a page that moves the schematic, as JSON data.

DIGITS = 6
"""Number of decimals of amplitudes and phases; a screen shows three."""
LEAST_SHARE = 1e-4
"""Least share of an element in the strain energy of a mode that is given; smaller ones have no colour to be seen."""


def mode_motion(rig: Drivetrain, modes: Modes) -> dict[str, Any]:
    """Motion of each mode and what the elements need to be coloured by, as JSON data.

    Returns
    -------
    dict
        ``modes``: rows with ``frequency_hz`` (natural, 0 of a rigid body), ``damped_hz``, ``damping_ratio`` (None of a
        rigid body), ``kind``, ``name``, ``description``, ``nodes``, which gives each node its amplitude, 1 at the node
        that moves most, and its phase in rad, and ``strain``, the shares of elements in the strain energy.
        ``elements``: for each element its ``type``, the nodes at its ends under ``nodes``, ground included, its main
        ``values`` in words, and ``mean_torque`` in N m where mean torques determine it. ``notes``: what to know of the
        modes.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("two discs", [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b",
    ...     inertia=1), tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)])
    >>> motion = mode_motion(rig, rig.modes())
    >>> [(mode["name"], mode["nodes"]["a"]) for mode in motion["modes"]]
    [('rigid body', [1.0, 0.0]), ('1', [0.5, 3.141593])]
    """
    from torsionnet.plot.drawing.labels import value_lines  # what draws is loaded by pages that show it
    from torsionnet.plot.drawing.pieces import plain_symbols

    torques = mean_torques(rig)
    return {
        "modes": [_mode(modes, number) for number in range(len(modes))],
        "elements": {
            name: {
                "type": element.kind.replace("_", " "),
                "nodes": list(dict.fromkeys(element.ports.values())),
                "values": ", ".join(map(plain_symbols, value_lines(element, rig.exact_values))),
            }
            | ({"mean_torque": torques[name]} if name in torques else {})
            for name, element in rig.elements.items()
        },
        "notes": list(modes.notes),
    }


def mean_torques(rig: Drivetrain) -> dict[str, float]:
    """Mean torques in N m by element, at the first node of each, of a drivetrain with a load or an operating point.

    Elements without one, as inertias and dampers, and those that mean torques do not determine are left out; empty
    where nothing gives mean torques, or these are out of balance.
    """
    try:
        loads = rig.static_state().loads
    except TorsionnetError:
        return {}
    torques: dict[str, float] = {}
    for load in loads:
        if load.torque is not None and np.isfinite(load.torque):
            torques.setdefault(load.element, float(load.torque))
    return torques


def _mode(modes: Modes, number: int) -> dict[str, Any]:
    amplitude, phase = _motion(modes, number)
    (natural,), (damped,), (ratio,) = (
        json_numbers(values[number : number + 1])
        for values in (modes.natural_frequencies, modes.damped_frequencies, modes.damping_ratios)
    )
    moved = zip(amplitude.tolist(), phase.tolist(), strict=True)
    return {
        "frequency_hz": natural,
        "damped_hz": damped,
        "damping_ratio": ratio,
        "kind": modes.kinds[number],
        "name": modes.names[number],
        "description": modes.descriptions[number],
        "nodes": dict(zip(modes.nodes, map(list, moved), strict=True)),
        "strain": {
            name: round(share, DIGITS)
            for name, share in zip(modes.elements, modes.strain[:, number].tolist(), strict=True)
            if abs(share) >= LEAST_SHARE
        },
    }


def _motion(modes: Modes, number: int) -> tuple[FloatArray, FloatArray]:
    """Amplitudes, 1 at the node that moves most, and phases in rad of the nodes in a mode, each of shape (n_nodes,)."""
    shape = np.nan_to_num(modes.shapes[:, number])
    amplitude = np.abs(shape)
    largest = float(amplitude.max(initial=0.0))
    amplitude = np.round(amplitude / largest, DIGITS) if largest > 0 else amplitude
    # A phase of a node that stands still would be noise.
    phase = np.where(amplitude > 0, np.round(np.angle(shape), DIGITS), 0.0)
    return np.asarray(amplitude), np.asarray(phase + 0.0)


# State of the explore page as a command line that prints the same numbers.


def command_text(session: Session, state: State) -> str:
    """Command line ``torsionnet frf MODEL ...``, or ``orders``, for a state of the page, quoted for the shell here.

    Examples
    --------
    >>> from torsionnet.app.explore import open_session
    >>> rig = open_session("amt_rig")
    >>> print(command_text(rig, rig.with_defaults(State({"gear": "V"}, {"c_O": 360}, band=(1.0, 50.0)))))
    torsionnet frf amt_rig -c V --set c_O=360 --output theta_1 --input T_M --band 1 50
    """
    words = ["torsionnet", "orders" if state.axis == "speed" else "frf", session.model]
    if state.choice:
        words += ["-c", label(dict(state.choice), session.base.definition.configurations)]
    for name, value in state.values.items():
        words += ["--set", f"{name}={value}"]
    words += ["--output", state.output, *([] if state.axis == "speed" else _response_options(session, state))]
    if state.axis == "speed" and session.measured is not None:
        words += ["--measured", str(session.measured)]
    if state.angle != "rad":
        words += ["--angle-unit", state.angle]
    words += ["--db"] * (state.decibels and state.axis == "frequency")
    return subprocess.list2cmdline(words) if os.name == "nt" else shlex.join(words)


def _response_options(session: Session, state: State) -> list[str]:
    """Options of ``torsionnet frf`` for the input, the band and the form of a response."""
    words = ["--input", state.input]
    if state.excitation and len(session.base.inputs) != 1:
        words += ["--driven-by", state.excitation]
    if any(state.band):
        words += ["--band", f"{state.band[0]:g}", f"{state.band[1]:g}"]
    if state.quantity:
        words += ["--kind", state.quantity]
    return words


MOST_PEAKS = 6
"""Largest number of peaks of a response that are marked in the plot; more labels would cover the curve."""


POINTS, PER_PEAK, LEAST_PER_PEAK = 300, 41, 9
MOST_AT_PEAKS = 1600
"""Largest number of frequencies of a plotted response around all peaks together; a screen has about as many columns
of pixels."""
UNDAMPED_RATIO = 1e-7
"""Damping ratio below which a vibration counts as undamped: its drawn height would depend on the nearest frequency."""
NEAREST_TO_POLE = 2e-4
"""Smallest relative distance of a plotted frequency from an undamped pole; the peak is drawn some thousand times its
flanks."""
APPROACH = 4.0 ** np.arange(1, 5) / 2
"""Distances from an undamped pole of the plotted frequencies added around it, in units of ``NEAREST_TO_POLE``."""


def answer(session: Session, state: State) -> dict[str, Any]:
    """Everything on the page that changes with its state, as JSON data; reasons under ``refused`` if impossible."""
    with collected_notes() as notes:
        try:
            return _answer(session, state) | {"notes": notes}
        except TorsionnetError as error:
            return {"refused": fault_texts(error), **_sliders_of_refused(session, state)}


def _sliders_of_refused(session: Session, state: State) -> dict[str, Any]:
    """Sliders of a state without results, as of an operating point out of balance; none of an impossible model."""
    try:
        return _sliders(session, state, session.model_for(state))
    except TorsionnetError:
        return {}


def _sliders(session: Session, state: State, rig: Drivetrain) -> dict[str, Any]:
    plain = session.model_in(state.choice)
    return {
        "parameters": [slider.to_data() for slider in sliders(plain, rig, state.values)],
        "operating_point": [slider.to_data() for slider in point_sliders(plain, rig, state.values)],
    }


@contextmanager
def collected_notes() -> Iterator[list[str]]:
    """Context manager that collects the library's warnings in a list of texts instead of printing them."""
    notes: list[str] = []
    warned: Counter[str] = Counter()
    with collected_warnings(warned):
        yield notes
    notes += warned


def fault_texts(error: TorsionnetError) -> list[str]:
    """Texts of every fault of an error, each with the entry of the model that has it."""
    if not isinstance(error, ModelError):
        return [str(error)]
    return [f"{_where(fault.path)}{fault.text}" for fault in error.faults]


def _where(path: tuple[str | int, ...]) -> str:
    named = ("operating point", *path[1:]) if path[:1] == ("operating_point",) else path[1:]
    return f"{' '.join(map(str, named))}: " if named else ""


def _answer(session: Session, state: State) -> dict[str, Any]:
    rig = session.model_for(state)
    shown = session.with_defaults(state)
    modes = page_modes(session, state, rig)
    return {
        "title": rig.title,
        "excitation": shown.excitation,
        **_sliders(session, state, rig),
        "modes": modes_data(modes),
        "cut": None,
        "findings": [fault.text for fault in rig.check() if fault.severity == "warning"],
        "command": command_text(session, replace(shown, values=session.given_values(shown))),
        **(
            {"orders": over_speed(rig, shown.output, rough=shown.rough, test=session.measured)}
            if state.axis == "speed"
            else _over_frequency(session, rig, shown, modes)
        ),
    }


def _over_frequency(session: Session, rig: Drivetrain, shown: State, modes: Modes) -> dict[str, Any]:
    measured = _measured(rig, shown)
    damped = [modes, measured] if measured else [modes]
    band = shown.band if any(shown.band) else vibration_range(*damped)
    response = respond(rig, shown, response_frequencies(band, *damped))
    return {
        "band": list(band),
        "response": response_data(response, _undamped(*damped)),
        "cut": modes_data(measured) if measured else None,
        "misfit": misfit(session.overlay, shown, lambda f: respond(rig, shown, f), band),
    }


def page_modes(session: Session, state: State, rig: Drivetrain) -> Modes:
    """Modes of a state's drivetrain that the page shows, of a large one only the lowest."""

    def solve() -> tuple[Modes, list[str]]:
        with collected_notes() as notes:
            return rig.modes(lowest=MOST_MODES if len(rig.nodes) > MANY_NODES else None), notes

    modes, notes = session.modes.once(state, solve)
    for note in notes:
        warn_user(note)
    return modes


def _measured(rig: Drivetrain, state: State) -> Modes | None:
    """Modes of the drivetrain cut at a measured input, the poles of that response; None where a torque drives."""
    if not state.excitation:
        return None
    lowest = MOST_MODES if len(rig.nodes) > MANY_NODES else None
    return rig.modes(measured_input=state.input, driven_by=state.excitation, lowest=lowest)


def respond(rig: Drivetrain, state: State, frequencies: FloatArray) -> FrequencyResponse:
    """Frequency response in SI that a state of the page shows, at frequencies in Hz."""
    response = rig.frequency_response(state.output, state.input, frequencies, driven_by=state.excitation or None)
    is_motion = response.outputs[0].unit in DERIVATIVE_ORDERS
    return getattr(response, state.quantity)() if state.quantity and is_motion else response


def response_data(response: FrequencyResponse, unbounded: FloatArray) -> dict[str, Any]:
    """Magnitude in SI and continuous phase in degrees of a response over Hz as JSON data, with factors to other units.

    ``unbounded`` are frequencies in Hz at which a peak has no height.
    """
    values = response.values[:, 0, 0]
    magnitude, phase = np.abs(values), unwrapped_phase(values)
    return {
        "label": f"{response.outputs[0].name}/{response.inputs[0].name}",
        "kind": response.kind(),
        "is_motion": response.outputs[0].unit in DERIVATIVE_ORDERS,
        "units": {angle: response.unit(conventions=shown) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "scales": {angle: response.scale(shown) for angle, shown in CONVENTIONS_BY_ANGLE.items()},
        "frequencies": json_numbers(response.frequencies),
        "magnitude": json_numbers(magnitude),
        "phase": json_numbers(phase),
        "peaks": _peaks(response.frequencies, magnitude, phase, unbounded),
        "notes": list(map(str, response.notes)),
    }


def _peaks(
    frequencies: FloatArray, magnitude: FloatArray, phase: FloatArray, unbounded: FloatArray
) -> list[list[float | None]]:
    """Frequency in Hz, magnitude (SI) and phase in degrees of a response's largest maxima, by rising frequency.

    None as height of undamped ones.
    """
    inner = magnitude[1:-1]
    with np.errstate(invalid="ignore"):
        at = 1 + np.flatnonzero((inner > magnitude[:-2]) & (inner >= magnitude[2:]) & np.isfinite(inner))
    largest = np.sort(at[np.argsort(-magnitude[at])][:MOST_PEAKS])
    near = [unbounded[np.abs(unbounded - frequencies[k]) < 4 * NEAREST_TO_POLE * unbounded] for k in largest]
    return [
        [float(pole[0]), None, None] if pole.size else [float(frequencies[k]), float(magnitude[k]), float(phase[k])]
        for k, pole in zip(largest, near, strict=True)
    ]


def modes_data(modes: Modes) -> dict[str, Any]:
    """Columns of the table of modes as JSON data, frequencies in Hz, eigenvalues in rad/s."""
    return {
        "title": modes.title,
        "natural": json_numbers(modes.natural_frequencies),
        "damped": json_numbers(modes.damped_frequencies),
        "ratio": json_numbers(modes.damping_ratios),
        "real": json_numbers(modes.eigenvalues.real),
        "imag": json_numbers(modes.eigenvalues.imag),
        "numbers": list(modes.numbers),
        "kinds": list(modes.kinds),
        "descriptions": list(modes.descriptions),
        "notes": list(modes.notes),
    }


def response_frequencies(band: tuple[float, float], *modes: Modes) -> FloatArray:
    """Frequencies of the plotted response in Hz, ascending, closer together around the modes.

    Examples
    --------
    >>> import torsionnet as tn
    >>> f = response_frequencies((0.5, 200.0), tn.load("dmf_rig").modes())
    >>> float(f[0]), float(f[-1]), 300 < len(f) < 400
    (0.5, 200.0, True)
    """
    vibrations = sum(int(np.sum(mode.damped_frequencies > 0)) for mode in modes)
    per_peak = min(PER_PEAK, max(LEAST_PER_PEAK, MOST_AT_PEAKS // max(1, vibrations)))
    f = Adaptive(*band, points=POINTS, per_peak=per_peak).frequencies(*modes)
    for pole in _undamped(*modes):
        f = f[np.abs(f - pole) > NEAREST_TO_POLE * pole]
        f = np.union1d(f, np.outer(pole, 1 + np.outer((-1, 1), NEAREST_TO_POLE * APPROACH)))
    return f[(f >= band[0]) & (f <= band[1])]


def _undamped(*modes: Modes) -> FloatArray:
    """Frequencies in Hz of vibrations without damping, shape (n,); several at one frequency count once."""
    frequencies = [
        mode.damped_frequencies[(mode.damped_frequencies > 0) & (mode.damping_ratios < UNDAMPED_RATIO)]
        for mode in modes
    ]
    every = np.sort(np.concatenate([np.empty(0), *frequencies]))
    return every[np.diff(every, prepend=0.0) > NEAREST_TO_POLE * every]
