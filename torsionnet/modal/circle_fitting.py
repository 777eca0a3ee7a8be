"""Circle fit, which finds natural frequency and damping ratio of one mode from its circle in the Nyquist plane."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.modal.modal_estimate import FEWEST_PEAK_LINES, line_spacing
from torsionnet.modal.spectral_lines import ORDERS, ComplexArray, FloatArray, Settings, lines_of

FEWEST_POINTS = 5
"""Fewest lines on a circle to which it is fitted, as three define it and the others show whether they lie on it."""
LOWEST_PART_OF_PEAK = 0.5
"""Magnitude over that of the peak down to which lines around it are fitted, as noise moves a shorter arc and other
modes a longer one.

A larger value takes a shorter arc, which noise moves more; a smaller one takes more of the neighbouring modes.
"""
POOR_CIRCLE, WIDE_SPREAD = 0.05, 0.1
"""RMS distance of points from the circle over its radius, and spread of damping ratios over their median, above which a
warning of noise or other modes is given."""


@dataclass(frozen=True, eq=False)
class CircleFit:
    """Mode identified by a circle fit, with natural frequency (Hz), damping ratio, modal constant and the circle.

    Attributes
    ----------
    natural_frequency : float
        Hz.
    damping_ratio : float
        Median of all pairs of points; of hysteretic damping half the loss factor.
    pairs : (n_below, n_above) array
        Damping ratio from each point below resonance with each one above it. A trend over them means that the points do
        not belong to one mode with this law of damping.
    spread : float
        Half the range of the middle 68 % of ``pairs``.
    modal_constant : complex
        A of ``A / (omega_r^2 - omega^2 + 2j zeta omega_r omega)``, the receptance; of ``j eta omega_r^2`` instead.
    center, radius : complex, float
        Centre and radius of the circle, in the unit of ``points``.
    angle : float
        Direction of the resonance from the centre, rad.
    residual : float
        Root mean square distance of the points from the circle over its radius.
    frequencies : (n,) array
        Hz, of the points.
    points : (n,) complex array
        The mobility (viscous) or the receptance (hysteretic).
    damping : {"viscous", "hysteretic"}
    label, unit, title : str
        Channels of the transfer function, unit of the points, and title.
    notes : tuple of str or Note
    """

    natural_frequency: float
    damping_ratio: float
    pairs: FloatArray
    spread: float
    modal_constant: complex
    center: complex
    radius: float
    angle: float
    residual: float
    frequencies: FloatArray
    points: ComplexArray
    damping: str
    label: str
    unit: str
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()

    @property
    def pole(self) -> complex:
        """Pole in rad/s of the viscous mode with this natural frequency and damping ratio."""
        omega, zeta = 2 * np.pi * self.natural_frequency, self.damping_ratio
        return complex(-zeta * omega + 1j * omega * np.sqrt(max(0.0, 1 - zeta**2)))


def circle_fit(
    response: FrequencyResponse,
    near: float,
    *,
    output: str | None = None,
    input: str | None = None,
    damping_model: Literal["viscous", "hysteretic"] = "viscous",
    band: tuple[float, float] | None = None,
) -> CircleFit:
    """Mode identified by a circle through the lines of one transfer function around a resonance.

    One viscous mode draws an exact circle in its mobility, a hysteretic one in its receptance; other modes move it as
    long as their share hardly changes over the lines taken. The response is integrated or differentiated as needed,
    and each point weighs as much as its line did in the response given. Seen from the centre, the angle of the points
    follows ``2 atan((omega_r / omega - omega / omega_r) / 2 zeta)``, or ``2 atan((1 - (omega / omega_r)^2) / eta)``:
    its least squares give the resonance, and each pair of points around it a damping ratio. With much damping even a
    stiffness in series bends the circle: the example reads 25.5 % where the pole has 25.7 %.

    Parameters
    ----------
    response : FrequencyResponse
    near : float
        Hz; the nearest peak is taken.
    output, input : str, optional
        Needed where there are several.
    damping_model : {"viscous", "hysteretic"}
    band : (float, float), optional
        Hz, the lines to take; by default those around the peak that are at least half as high, up to the valley
        between it and the next peak.

    Raises
    ------
    UsageError
        Several transfer functions, too few lines.
    SolveError
        The points do not turn as those of a resonance do.

    References
    ----------
    Kennedy and Pancu 1947; Ewins, Modal Testing, 2nd ed., section 4.3.

    Examples
    --------
    >>> import torsionnet as tn
    >>> test = tn.load("dmf_rig").frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.05))
    >>> fit = circle_fit(test, near=8)
    >>> round(fit.natural_frequency, 3), round(fit.damping_ratio, 4)
    (8.755, 0.2547)
    """
    if damping_model not in ("viscous", "hysteretic"):
        raise UsageError(
            f'damping_model "{damping_model}" is not known; choose viscous or hysteretic', kind="unknown-word"
        )
    chosen = response.select(output, input)
    if len(chosen.outputs) * len(chosen.inputs) != 1:
        raise UsageError("a circle is fitted to one transfer function; name its output= and input=", kind="wrong-count")
    return _fitted(chosen, *_fitted_points(chosen, near, damping_model, band), damping_model)


def _fitted_points(
    response: FrequencyResponse, near: float, damping: str, band: tuple[float, float] | None
) -> tuple[FloatArray, ComplexArray, FloatArray, str]:
    """Frequency in rad/s, mobility or receptance, and weight of each line fitted, each (n,), and the points' unit."""
    lines = lines_of(response, Settings())
    # Viscous damping makes a circle of the mobility, hysteretic damping one of the receptance.
    steps = (damping == "viscous") - int(lines.powers[0, 0])
    omega = np.abs(lines.s)
    points = lines.values[:, 0, 0] * lines.s**steps
    taken = _around(np.abs(points), omega, 2 * np.pi * near) if band is None else _within(omega, band)
    if taken.stop - taken.start < FEWEST_POINTS:
        raise UsageError(
            f"only {taken.stop - taken.start} lines lie on the circle near {near:g} Hz and {FEWEST_POINTS} are needed; "
            "use finer lines, or give a wider band",
            kind="too-short",
        )
    weights = lines.weights[:, 0, 0] * omega ** -float(steps)
    return omega[taken], points[taken], weights[taken] / weights[taken].max(), _unit(response, steps)


def _unit(response: FrequencyResponse, steps: int) -> str:
    output, into = response.outputs[0], response.inputs[0]
    if output.unit in ORDERS and steps:
        unit = {order: unit for unit, order in ORDERS.items()}[ORDERS[output.unit] + steps]
        response = replace(response, outputs=(Channel(output.name, unit),))
        return response.unit()
    if not steps:
        return response.unit()
    return f"{response.unit()} s^{-steps}" if into.unit == output.unit else f"({response.unit()}) s^{-steps}"


def _within(omega: FloatArray, band: tuple[float, float]) -> slice:
    kept = np.flatnonzero((omega >= 2 * np.pi * band[0]) & (omega <= 2 * np.pi * band[1]))
    return slice(int(kept[0]), int(kept[-1]) + 1) if len(kept) else slice(0, 0)


def _around(size: FloatArray, omega: FloatArray, near: float) -> slice:
    """Range of lines around the peak nearest to a frequency, at least half as high, to the valleys beside it."""
    from scipy.signal import find_peaks

    summits = find_peaks(size, prominence=0.1 * size.max())[0]
    if not len(summits):
        raise UsageError(
            f"there is no peak near {near / (2 * np.pi):g} Hz; give the band= of the lines to take", kind="no-resonance"
        )
    place = int(np.abs(omega[summits] - near).argmin())
    before, top, after = np.concatenate([[0], summits, [len(size)]])[place : place + 3].tolist()
    ends = []
    # To the valley on each side, at most to where the curve has fallen to that part of its peak.
    for side in (size[before : top + 1][::-1], size[top:after]):
        low = np.flatnonzero(side < LOWEST_PART_OF_PEAK * size[top])
        end = int(low[0]) if len(low) else len(side)
        ends.append(int(side[:end].argmin()) + 1)
    return slice(top - ends[0] + 1, top + ends[1])


def _fitted(
    response: FrequencyResponse,
    omega: FloatArray,
    points: ComplexArray,
    weights: FloatArray,
    unit: str,
    damping: str,
) -> CircleFit:
    center, radius = _circle(points, weights)
    seen = np.unwrap(np.angle(points - center))
    angle, resonance = _resonance(omega, seen, damping)
    pairs = _pairs(omega, seen - angle, resonance, damping)
    zeta, spread = float(np.median(pairs)), float(np.diff(np.percentile(pairs, [16, 84]))[0] / 2)
    # At resonance the diameter 2 R is A/(2 zeta omega_0) of the mobility, or A/(j eta omega_0^2) of the receptance
    # with eta = 2 zeta.
    law = 4 * radius * zeta * resonance * (1 if damping == "viscous" else 1j * resonance)
    fit = CircleFit(
        natural_frequency=resonance / (2 * np.pi),
        damping_ratio=zeta,
        pairs=pairs,
        spread=spread,
        modal_constant=complex(law * np.exp(1j * angle)),
        center=center,
        radius=radius,
        angle=angle,
        residual=float(np.sqrt(np.mean((np.abs(points - center) - radius) ** 2)) / radius),
        frequencies=omega / (2 * np.pi),
        points=points,
        damping=damping,
        label=f"{response.outputs[0].name}/{response.inputs[0].name}",
        unit=unit,
        title=response.title,
    )
    return replace(fit, notes=tuple(_remarks(fit)))


def _circle(points: ComplexArray, weights: FloatArray) -> tuple[complex, float]:
    """Centre and radius of the circle by least squares of distances, started from the algebraic fit (Kåsa 1976)."""
    import scipy.optimize

    size = float(np.abs(points).max())
    x, y = points.real / size, points.imag / size
    # x^2 + y^2 = a x + b y + c is linear in the centre (a/2, b/2) and in c = R^2 - (a^2 + b^2)/4.
    design = np.stack([x, y, np.ones_like(x)], axis=1) * weights[:, None]
    a, b, c = np.linalg.lstsq(design, (x**2 + y**2) * weights)[0]
    start = [a / 2, b / 2, np.sqrt(max(c + (a**2 + b**2) / 4, 1e-12))]

    def distances(p: FloatArray) -> FloatArray:
        return np.asarray(weights * (np.hypot(x - p[0], y - p[1]) - p[2]))

    p = scipy.optimize.least_squares(distances, start, method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    return complex(p[0], p[1]) * size, abs(float(p[2])) * size


def _detuning(omega: FloatArray, resonance: float, damping: str) -> FloatArray:
    """Distance of each frequency from resonance, without unit, 2 zeta (or eta) times the tangent of half the angle."""
    ratio = omega / resonance
    return np.asarray(ratio - 1 / ratio if damping == "viscous" else ratio**2 - 1)


def _resonance(omega: FloatArray, seen: FloatArray, damping: str) -> tuple[float, float]:
    """Angle (rad) and frequency (rad/s) of the resonance on the circle by least squares of the points' angles."""
    import scipy.optimize

    sweep = seen[0] - seen[-1]
    if sweep <= 0:
        text = "the points do not turn clockwise with frequency: no resonance, or motion ~ exp(-j omega t)"
        raise SolveError(
            f"{text}; give the band= of one resonance, or the conjugate of the response", kind="no-resonance"
        )
    # Points move along the circle fastest at resonance.
    fastest = int(np.argmax(-np.diff(seen) / np.diff(omega)))
    start_omega = float(np.mean(omega[fastest : fastest + 2]))
    # angle = angle_0 - 2 atan(detuning/width) of a single mode: the width from the range of angles seen.
    width = np.ptp(_detuning(omega, start_omega, damping)) / (2 * np.tan(min(sweep / 4, 1.5)))
    start = [float(np.mean(seen[fastest : fastest + 2])), 0.0, np.log(max(width, 1e-9))]

    def deviations(p: FloatArray) -> FloatArray:
        detuning = _detuning(omega, start_omega * np.exp(p[1]), damping)
        return np.asarray(seen - p[0] + 2 * np.arctan(detuning * np.exp(-p[2])))

    solution = scipy.optimize.least_squares(deviations, start, method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    resonance = float(start_omega * np.exp(solution[1]))
    if not omega[1] < resonance < omega[-2]:
        raise SolveError(
            f"the resonance of the circle would be at {resonance / (2 * np.pi):.4g} Hz, at the edge of its points or "
            "outside them; give another band=",
            kind="no-resonance",
        )
    return float(solution[0]), resonance


def _pairs(omega: FloatArray, angle: FloatArray, resonance: float, damping: str) -> FloatArray:
    """Damping ratios from each pair of a point below and one above resonance, (n_below, n_above)."""
    detuning, tangent = _detuning(omega, resonance, damping), np.tan(np.clip(angle / 2, -1.55, 1.55))
    below, above = omega < resonance, omega > resonance
    distance = detuning[above] - detuning[below][:, None]
    return np.asarray(distance / (2 * (tangent[below][:, None] - tangent[above])))


def _remarks(fit: CircleFit) -> Iterator[NoteOrText]:
    # A count of lines would depend on rounding where a line lies on the very edge.
    width = 2 * abs(fit.damping_ratio) * fit.natural_frequency
    lines = width / line_spacing(fit.frequencies, fit.natural_frequency)
    if lines < FEWEST_PEAK_LINES:
        yield (
            warning(
                f"only {lines:.2g} lines within the half-power bandwidth at {fit.natural_frequency:.4g} Hz: if a "
                "window was used, the damping reads high"
            )
        )
    if fit.residual > POOR_CIRCLE:
        yield warning(f"the points lie {fit.residual:.1%} of the radius off the circle: noise, or not one mode alone")
    if fit.spread > WIDE_SPREAD * abs(fit.damping_ratio):
        yield (
            warning(
                f"damping from pairs of points scatters by {fit.spread / abs(fit.damping_ratio):.0%}: noise, "
                "neighbouring modes, or another law of damping"
            )
        )
