"""Refinement of poles by least weighted squares of the transfer functions themselves, with standard errors.

The linear fits minimise squares of an equation, which noise biases. Here the squares of ``H - model`` are minimised
over the poles, with the residues eliminated (variable projection; Golub and Pereyra 1973, Kaufman 1975). An
oscillatory mode is ``s^2 + b s + c``: as b grows it becomes two real poles without a step.

Modes fitted to the record behind an estimate: one window as long as the record, with the transients at its ends. The
windows of an estimate widen peaks, so that a mode comes as two or with too much damping, and no number of averages
helps. The lines of the whole record have no such error once the free decays at its ends are unknowns of the fit (R.
Pintelon and J. Schoukens, System Identification, 2nd ed., chapters 6 and 9): ``Y = s^p H X + T``, T with the poles of
H. Noise on the input counts as noise on the outputs that the response has shaped.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.matrix_fraction import largest_order, poles_of_orders
from torsionnet.modal.residues import Expansion, Projection, coefficients_of, expand
from torsionnet.modal.selection import BicCriterion, line_correlation, pole_count
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines, Settings
from torsionnet.signals.recording import Recording
from torsionnet.signals.resampling import FILTER_HALF_LENGTH

SMALLEST_VALUE = 1e-12
"""Least coefficient, and least residual over the response, that is assumed, as their logarithm and inverse are
needed."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of residuals at neighbouring lines that is assumed, as at 1 standard errors would be infinite."""
NOISE_SHARE, FEWEST_NEIGHBOURS, MOST_NEIGHBOURS = 40, 10, 100
"""Share of the lines of a record (1/40), with limits, that the noise at each line is the mean of on either side."""
INPUT_SHARES = np.logspace(0, 8, 17)
"""Noise that comes from the input over that of the output, at the largest response, that are tried."""
CLEAR_LIKELIHOOD = 5.0
"""Gain of the logarithm of the likelihood from which noise is put on the input."""
ROUNDS = 2
"""Number of fits in a refinement, the second with weights from the residuals of the first, as more change them
little."""


@dataclass(frozen=True, eq=False)
class RefinedPoles:
    """Refined poles in rad/s, sorted by magnitude, with standard errors of natural frequency and damping ratio.

    Attributes
    ----------
    poles : (n,) complex array
        rad/s.
    frequency_errors, damping_errors : (n,) arrays
        Standard errors of the natural frequency in Hz and of the damping ratio.
    converged : bool
    problem : Projection
        Problem of the last round, over lines whose s is divided by the highest.
    logarithms : (n_coefficients,) array
        Its solution.
    """

    poles: ComplexArray
    frequency_errors: FloatArray
    damping_errors: FloatArray
    converged: bool
    problem: Projection
    logarithms: FloatArray


def refine(lines: Lines, poles: ComplexArray, settings: Settings) -> RefinedPoles:
    """Refined poles (rad/s) and standard errors from stable start poles, with weights from the residuals."""
    scale = float(np.abs(lines.s).max())
    scaled = replace(lines, s=lines.s / scale)
    sizes, start = factors_of(poles / scale)
    # Logarithms keep coefficients positive, and so poles stable; each round weighs by the last one's residuals.
    for _ in range(ROUNDS):
        problem = Projection(scaled, sizes, settings)
        logarithms, converged = minimised(problem, start)
        start = coefficients_of(logarithms)
        left = problem.complex_residuals(logarithms)
        scaled = reweighted(problem, logarithms)
    covariance = _covariance(Projection(scaled, sizes, settings), logarithms, left)
    roots, slopes = roots_of(sizes, start)
    frequency, damping = _errors(roots, slopes, covariance)
    order = np.argsort(np.abs(roots), kind="stable")
    per_turn = scale / (2 * np.pi)
    return RefinedPoles(
        roots[order] * scale, frequency[order] * per_turn, damping[order], converged, problem, logarithms
    )


def minimised(problem: Projection, start: FloatArray, exact: float = 1e-14) -> tuple[FloatArray, bool]:
    """Logarithms of the denominator's coefficients at the least squares near start coefficients, and success."""
    import scipy.optimize

    solution = scipy.optimize.least_squares(
        problem.residuals,
        np.log(np.maximum(start, SMALLEST_VALUE)),
        problem.jacobian,
        method="lm",
        xtol=10 * exact,
        ftol=exact,
        gtol=exact,
    )
    return solution.x, bool(solution.status > 0)


def factors_of(poles: ComplexArray) -> tuple[tuple[int, ...], FloatArray]:
    """Degrees of the denominator's factors for given poles, and the coefficients of all factors in a row.

    Coefficients are (b, c) of s^2 + b s + c for a conjugate pair or two real poles, (a,) of s + a for a last real pole.
    """
    # (s - lambda)(s - lambda^*) = s^2 - 2 Re(lambda) s + |lambda|^2; real poles are taken in pairs.
    factors: list[tuple[float, ...]] = [(-2 * pole.real, abs(pole) ** 2) for pole in poles if pole.imag != 0]
    real = sorted(-pole.real for pole in poles if pole.imag == 0)
    factors += [(a + b, a * b) for a, b in zip(real[::2], real[1::2], strict=False)]
    if len(real) % 2:
        factors.append((real[-1],))
    return tuple(len(factor) for factor in factors), np.array([value for factor in factors for value in factor])


def roots_of(sizes: tuple[int, ...], coefficients: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Roots (n,) of a product of polynomials, one of each pair, and derivatives to the logarithms of coefficients."""
    poles: list[complex] = []
    slopes: list[ComplexArray] = []
    place = 0
    for size in sizes:
        own = slice(place, place + size)
        for root in np.roots([1.0, *coefficients[own]]).astype(complex):
            if root.imag >= 0:
                slope = np.zeros(len(coefficients), dtype=complex)
                # From s^2 + a s + b = 0: ds/d ln a = -a s/(2 s + a), ds/d ln b = -b/(2 s + a).
                inner = 2 * root + coefficients[place] if size > 1 else 1.0
                slope[own] = -np.array([root, 1.0])[-size:] / inner * coefficients[own]
                poles.append(root)
                slopes.append(slope)
        place += size
    return np.array(poles, dtype=complex), np.array(slopes).reshape(len(poles), len(coefficients))


def reweighted(problem: Projection, logarithms: FloatArray) -> Lines:
    """Copy of the lines with weights that give the residuals of each transfer function a mean square of 1.

    The lines of a record are many: there the mean is over the neighbours of each line, and noise may have any colour.
    """
    lines, left = problem.lines, problem.complex_residuals(logarithms)
    squares = np.abs(left) ** 2
    if lines.drive is None:
        size = np.sqrt(np.mean(squares, axis=0))
    else:
        passed = np.abs(problem.responses(logarithms) * lines.weights) ** 2
        size = np.empty(left.shape)
        for place in np.ndindex(*left.shape[1:]):
            at = (slice(None), *place)
            size[at] = np.sqrt(_variance(squares[at], passed[at]))
    # A response that is fitted down to rounding must not take all the weight.
    floor = SMALLEST_VALUE * np.sqrt(np.mean(np.abs(lines.weights * lines.values) ** 2, axis=0))
    return replace(lines, weights=lines.weights / np.maximum(size, floor))


def _variance(squares: FloatArray, passed: FloatArray) -> FloatArray:
    """Variance of the noise at each line of a record from squares of residuals, the mean over its neighbours, (n_f,).

    Noise on the input is as large as the squares of the response, ``passed``, and differs much between neighbours at a
    narrow peak: its share is the most likely one.
    """
    reach = int(np.clip(len(squares) / NOISE_SHARE, FEWEST_NEIGHBOURS, MOST_NEIGHBOURS))
    around = np.ones(2 * reach + 1)
    counts = np.convolve(np.ones(len(squares)), around, "same")
    tiny = np.finfo(float).tiny
    # Noise even over neighbouring lines, and with a part in proportion to the response, as noise of the input makes.
    shapes = [np.ones(len(squares)), *(1 + share * passed / max(passed.max(), tiny) for share in INPUT_SHARES)]
    variances: list[FloatArray] = [shape * np.convolve(squares / shape, around, "same") / counts for shape in shapes]
    # Minus log-likelihood of complex normal residuals; a part of the input has to be clearly likelier.
    unlikely = [float(np.sum(np.log(each + tiny) + squares / (each + tiny))) for each in variances]
    place = int(np.argmin(unlikely))
    return variances[place if unlikely[place] < unlikely[0] - CLEAR_LIKELIHOOD else 0]


def _covariance(problem: Projection, point: FloatArray, left: ComplexArray) -> FloatArray:
    """Covariance of the coefficients' logarithms, enlarged where residuals of neighbouring lines correlate."""
    slopes = problem.jacobian(point)
    normal = slopes.T @ slopes
    # Residuals that correlate by rho from line to line count as (1 - rho)/(1 + rho) of their number.
    along = np.sum(left[1:] * left[:-1].conj()).real / max(float(np.sum(np.abs(left) ** 2)), np.finfo(float).tiny)
    correlation = float(np.clip(along, 0, LARGEST_CORRELATION))
    over = problem.residuals(point)
    variance = float(over @ over) / max(1, len(over) - problem.unknowns)
    return np.asarray(np.linalg.pinv(normal, hermitian=True) * variance * (1 + correlation) / (1 - correlation))


def _errors(poles: ComplexArray, slopes: ComplexArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard errors of ``|lambda|`` and of the damping ratio of each pole, each (n,), from the covariance."""
    size = np.abs(poles)[:, None]
    # d|lambda| = Re(lambda^* d lambda)/|lambda|, and zeta = -Re(lambda)/|lambda|.
    along = (poles.conj()[:, None] * slopes).real / size
    damping = -slopes.real / size + poles.real[:, None] * along / size**2
    first, second = (
        np.sqrt(np.maximum(np.einsum("np,pq,nq->n", part, covariance, part), 0)) for part in (along, damping)
    )
    return first, second


# Modes fitted to the record behind an estimate: one window as long as the record, with the transients at its ends.

ONE_RECORD = ("H1", "H2")
"""Estimators of one input for which the fit to the record stands, as they need no other statement on the noise."""
LEAST_HIGHEST_ORDER, MORE_ORDERS = 12, 8
"""Highest order of the polynomials at least fitted to a record, and orders beyond those of the poles that its estimate
shows, as windows hide modes, or beyond the best one."""
ENOUGH = 1e-8
"""Relative change of the squares below which a fit ends that only decides which poles are worth their unknowns."""
HIDDEN_FREQUENCIES, HIDDEN_DAMPINGS = 12, (0.2, 0.4, 0.7)
"""Natural frequencies over the band, and damping ratios, at which hidden modes are sought: orders show light ones."""
LEAST_GAIN = 22.0
"""Fall of the residuals' squares over their mean with which a hidden mode counts: by chance, in one of 1000 records
(chi-squared of four unknowns, five independent places)."""
PASSES = 2
"""Choices of the order, the second with the noise that the first leaves at each line."""


@dataclass(frozen=True, eq=False)
class RecordFit:
    """Modes fitted to a record, with the share (n_out, n_in) of its spectrum that they leave over."""

    refined: RefinedPoles
    expansion: Expansion
    misfit: FloatArray


def record_lines(response: FrequencyResponse, lines: Lines, poles: ComplexArray, settings: Settings) -> Lines | str:
    """Lines of the record behind an estimate in the band of its own lines, or why there are none, in words."""
    origin, inputs = response.estimation, [channel.name for channel in response.inputs]
    if origin is None:
        return "how it was averaged is not known"
    if len(inputs) > 1:
        return "the estimate has several inputs"
    if origin.estimator not in ONE_RECORD:
        return f"{origin.estimator} supposes noise on the input"
    names = [channel.name for channel in response.outputs]
    if not isinstance(record := origin.record, Recording) or not {*names, *inputs} <= set(record.names):
        return "its record is not at hand"
    ends = FILTER_HALF_LENGTH if origin.decimation > 1 else 0  # there a filter has met what is no part of the record
    kept = slice(ends, len(record) - ends)
    frequencies = np.fft.rfftfreq(len(record) - 2 * ends, 1 / record.sampling_rate)
    band = np.abs(lines.s[[0, -1]]) / (2 * np.pi)
    inside = (frequencies >= band[0] * (1 - 1e-9)) & (frequencies <= band[1] * (1 + 1e-9))
    torque = record[inputs[0]]
    # Spectrum of the torque as it acts, between its samples too.
    course = torque.course(record.sampling_rate).share(frequencies[inside])
    drive = np.fft.rfft(torque.values[kept])[inside] * course
    values = np.stack([np.fft.rfft(record[name].values[kept])[inside] for name in names], axis=1)[:, :, None]
    if not np.count_nonzero(drive) or not np.abs(values).max(axis=(0, 2)).all():
        return "a signal of its record stands still"
    weights = np.broadcast_to(1 / np.sqrt(np.mean(np.abs(values) ** 2, axis=0)), values.shape).copy()
    of_record = Lines(np.asarray(2j * np.pi * frequencies[inside]), values, lines.powers, weights, drive)
    too_few = Projection(of_record, factors_of(poles)[0], settings).unknowns > values.size
    return "its record is too short" if too_few else of_record


def fit_record(lines: Lines, start: ComplexArray, settings: Settings, *, automatic: bool) -> RecordFit:
    """Modes fitted to the lines of a record from start poles in rad/s, ``automatic`` as many as lower the BIC."""
    poles = _poles_worth_their_unknowns(lines, start, settings) if automatic else start
    refined = refine(lines, poles, settings)
    problem, at = refined.problem, refined.logarithms
    expansion = expand(replace(problem.without_transients(at), s=lines.s), refined.poles, settings)
    left = problem.complex_residuals(at) / problem.lines.weights
    share = np.sqrt(np.sum(np.abs(left) ** 2, axis=0) / np.sum(np.abs(lines.values) ** 2, axis=0))
    return RecordFit(refined, expansion, np.asarray(share))


def _poles_worth_their_unknowns(lines: Lines, start: ComplexArray, settings: Settings) -> ComplexArray:
    """Poles in rad/s worth their unknowns, of the start poles and of linear fits of rising order to the record."""
    scale = float(np.abs(lines.s).max())
    scaled = replace(lines, s=lines.s / scale)
    highest = settings.highest_order or max(LEAST_HIGHEST_ORDER, pole_count(start) + MORE_ORDERS)
    highest = min(highest, largest_order(lines, settings) // 2)
    best = start / scale
    # The BIC weighs by the noise of the best fit, which each pass knows better.
    for _ in range(PASSES):
        candidates, left, values = [best], [_left(scaled, best, settings)], [np.inf]
        for poles, _ in poles_of_orders(scaled, highest, replace(settings, method="rational")):
            if len(poles):
                candidates.append(poles)
                left.append(_left(scaled, poles, settings))
            criterion = BicCriterion(scaled, min(left, key=lambda each: float((np.abs(each) ** 2).sum())))
            values = [criterion.value(each, pole_count(poles)) for each, poles in zip(left, candidates, strict=True)]
            if len(candidates) > int(np.argmin(values)) + MORE_ORDERS + 1:
                break
        place = int(np.argmin(values))
        best = candidates[place]
        scaled = _with_noise_of(scaled, best, settings)
    while len(fewer := _without_useless(scaled, best, settings)) < len(best):
        best, scaled = fewer, _with_noise_of(scaled, fewer, settings)  # what useless poles took is noise, too
    return _with_hidden(scaled, fewer, settings, highest) * scale


def _with_noise_of(lines: Lines, poles: ComplexArray, settings: Settings) -> Lines:
    """Copy of the lines with weights by the noise that given poles with their best residues leave."""
    sizes, coefficients = factors_of(poles)
    return reweighted(Projection(lines, sizes, settings), np.log(coefficients))


def _without_useless(lines: Lines, poles: ComplexArray, settings: Settings) -> ComplexArray:
    """Poles left when the least useful one is dropped, and the others fitted again, while that lowers the BIC."""
    poles, left = _fitted(lines, poles, settings)
    while len(poles) > 1:
        criterion = BicCriterion(lines, left)
        trials = [np.delete(poles, place) for place in range(len(poles))]
        sizes = [float((np.abs(_left(lines, rest, settings)) ** 2).sum()) for rest in trials]
        fewer, over = _fitted(lines, trials[int(np.argmin(sizes))], settings)
        if criterion.value(over, pole_count(fewer)) >= criterion.value(left, pole_count(poles)):
            break
        poles, left = fewer, over
    return poles


def _with_hidden(lines: Lines, poles: ComplexArray, settings: Settings, highest: int) -> ComplexArray:
    """Poles, and strongly damped ones beside them that the residuals show, though not clearly enough for the BIC.

    Without them the standard errors of the others would not cover what they make of the part of a hidden mode.
    """
    low, high = np.abs(lines.s[[0, -1]])
    tried = [(w, z) for w in np.geomspace(low, high, HIDDEN_FREQUENCIES) for z in HIDDEN_DAMPINGS]
    factors = np.array([(2 * z * w, w**2) for w, z in tried])
    while pole_count(poles) + 2 <= highest:
        sizes, coefficients = factors_of(poles)
        problem = Projection(lines, sizes, settings)
        gains = problem.gains(np.log(coefficients), factors)
        # Lines that correlate by rho count as (1 - rho)/(1 + rho) of their number.
        same = line_correlation(problem.complex_residuals(np.log(coefficients)))
        if gains.max() * (1 - same) / (1 + same) < LEAST_GAIN:
            break
        hidden, _ = roots_of((2,), factors[int(np.argmax(gains))])
        poles, _ = _fitted(lines, np.append(poles, hidden), settings)
    return poles


def _fitted(lines: Lines, poles: ComplexArray, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Poles of the least squares nearest to start poles, with the weighted residuals, (n_f, n_out, n_in)."""
    sizes, start = factors_of(poles)
    problem = Projection(lines, sizes, settings)
    logarithms, _ = minimised(problem, start, ENOUGH)
    return roots_of(sizes, coefficients_of(logarithms))[0], problem.complex_residuals(logarithms)


def _left(lines: Lines, poles: ComplexArray, settings: Settings) -> ComplexArray:
    """Weighted residuals (n_f, n_out, n_in) with given poles and their best residues."""
    sizes, coefficients = factors_of(poles)
    return Projection(lines, sizes, settings).complex_residuals(np.log(coefficients))
