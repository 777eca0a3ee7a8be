r"""Straight lines joined at break points, with friction on each, fitted to both branches of a loop at once.

The torque is T = S(gamma) + M_i where the twist rises and S(gamma) - M_i where it falls. The spring line S has the
slope k_i on piece i, from the break g_i to g_(i+1). A sample counts by its distance from its branch in units of both
noises, of torque and of twist, to the point of the branch that is nearest:

    d^2 = min over x ((gamma - x)/s_gamma)^2 + ((T - S(x) -+ M)/s_T)^2.

Torque alone on twist would flatten steep flanks (regression dilution). Without noise of the twist d is the usual
residual. How many pieces there are, an F test says.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.signals.recording import FloatArray

FAILED = 2
"""Number of further breaks in a row that bring nothing, after which no more are looked for."""
MOST_BREAKS = 6
"""Most break points that are looked for, three a side; a line that asks for more bends all along."""
PLACES = 32
"""Number of places at which a further break is tried before its place is refined."""
SHORTEST = 10
"""Fewest samples of a cycle on a piece between two breaks."""
SIGNIFICANCE = 1e-6
"""Share of loops without a further stage in which the F test finds one all the same."""
STEPS = 12
"""Most steps of Gauss and Newton."""
HALVINGS = 6
"""Most halvings of a step that makes the sum of squares larger."""
SETTLED = 1e-8
"""Relative fall of the sum of squares at which the fit stops."""
THINNED = 2000
"""Number of samples to which the loops of all cycles are thinned before breaks are looked for."""


@dataclass(frozen=True, eq=False)
class LoopSamples:
    """Samples of both branches: twist in rad, torque in N m, sense 1 or -1, each (n,), and the noise of both."""

    twist: FloatArray
    torque: FloatArray
    sense: FloatArray
    twist_noise: float
    torque_noise: float

    def chosen(self, which: NDArray[np.bool_] | slice) -> LoopSamples:
        """Copy with some of the samples."""
        return replace(self, twist=self.twist[which], torque=self.torque[which], sense=self.sense[which])


@dataclass(frozen=True, eq=False)
class JoinedLines:
    """Spring line of joined straight pieces, and the friction torque on each.

    Attributes
    ----------
    centre, level : float
        A twist in rad, and the torque of the spring line there in N m.
    slopes : (p + 1,) array
        Stiffness of each piece, N m/rad.
    breaks : (p,) array
        Twists at which pieces join, rad, rising.
    friction : (p + 1,) array
        Friction torque on each piece, N m.
    """

    centre: float
    level: float
    slopes: FloatArray
    breaks: FloatArray
    friction: FloatArray

    def torque(self, twist: FloatArray) -> FloatArray:
        """Torque of the spring line in N m at twists in rad, shape (n,)."""
        return self._from(0.0, twist) - self._from(0.0, np.array([self.centre])) + self.level

    def piece(self, twist: FloatArray) -> NDArray[np.intp]:
        """Number of the piece on which twists in rad lie, shape (n,)."""
        return np.asarray(np.searchsorted(self.breaks, twist))

    def _from(self, origin: float, twist: FloatArray) -> FloatArray:
        torque = self.slopes[0] * (twist - origin)
        for at, change in zip(self.breaks, np.diff(self.slopes), strict=True):
            torque = torque + change * np.maximum(twist - at, 0.0)
        return np.asarray(torque)

    def loop(self, twist: FloatArray, sense: FloatArray) -> FloatArray:
        """Torque in N m on the branches at twists in rad with their sense, 1 or -1, shape (n,)."""
        return np.asarray(self.torque(twist) + sense * self.friction[self.piece(twist)])

    def distances(self, samples: LoopSamples) -> FloatArray:
        """Distances of samples from their branch in units of both noises, shape (n,), positive above it."""
        lows, highs = np.r_[-np.inf, self.breaks], np.r_[self.breaks, np.inf]
        anchors = np.r_[self.breaks[:1], self.breaks] if len(self.breaks) else np.array([self.centre])
        levels = self.torque(anchors)
        k, x = self.slopes[:, None], anchors[:, None]
        over = samples.torque - samples.sense * self.friction[:, None] - levels[:, None]
        rest = over - k * (samples.twist - x)
        # Nearest point of the line of a piece, kept on the piece.
        twist_noise, torque_noise = samples.twist_noise**2, samples.torque_noise**2
        moved = rest * k * twist_noise / (torque_noise + k**2 * twist_noise)
        foot = np.clip(samples.twist + moved, lows[:, None], highs[:, None])
        off = np.where(foot == samples.twist + moved, -moved, samples.twist - foot)
        up = over - k * (foot - x)
        squares = (off / samples.twist_noise) ** 2 + (up / samples.torque_noise) ** 2
        nearest = squares.argmin(axis=0)
        at = np.arange(len(nearest))
        return np.asarray(np.sqrt(squares[nearest, at]) * np.where(rest[nearest, at] < 0, -1.0, 1.0))

    def numbers(self) -> FloatArray:
        """Level, slopes, breaks and friction torques in one row, as a fit varies them."""
        return np.concatenate([[self.level], self.slopes, self.breaks, self.friction])

    def with_numbers(self, row: FloatArray) -> JoinedLines:
        """Copy with other level, slopes, breaks and friction torques."""
        pieces = len(self.slopes)
        level, slopes, breaks, friction = np.split(row, [1, 1 + pieces, 2 * pieces])
        return JoinedLines(self.centre, float(level[0]), slopes, breaks, friction)


def fitted(start: JoinedLines, samples: LoopSamples) -> tuple[JoinedLines, float]:
    """Joined lines at the least sum of squared distances from a start on, by Gauss and Newton, and that sum."""
    lines, rest = start, start.distances(samples)
    span = float(np.ptp(samples.twist))
    for _ in range(STEPS):
        row = lines.numbers()
        pieces = len(lines.slopes)
        torque = max(float(np.ptp(samples.torque)), samples.torque_noise)
        scale = np.repeat([torque, torque / span, span, torque], [1, pieces, pieces - 1, pieces])
        # Slopes of the distances by differences, and the Gauss-Newton step -(J J^T)^-1 J d, scaled by sizes.
        columns = [
            (lines.with_numbers(row + 1e-6 * size * unit).distances(samples) - rest) / 1e-6
            for size, unit in zip(scale, np.eye(len(row)), strict=True)
        ]
        rows = np.stack(columns)
        step = -scale * np.linalg.lstsq(rows @ rows.T, rows @ rest, rcond=1e-13)[0]
        shorter = _shorter(lines, step, samples, float(rest @ rest))
        if shorter is None:
            break
        fell = 1 - (shorter[1] @ shorter[1]) / (rest @ rest) if rest.any() else 0.0
        lines, rest = shorter
        if fell < SETTLED:
            break
    return lines, float(rest @ rest)


def _shorter(
    lines: JoinedLines, step: FloatArray, samples: LoopSamples, before: float
) -> tuple[JoinedLines, FloatArray] | None:
    """Lines and distances after the longest part of a step that makes the sum of squares smaller; None: none does."""
    for halved in range(HALVINGS):
        moved = lines.with_numbers(lines.numbers() + step / 2**halved)
        if np.all(np.diff(moved.breaks) > 0) and np.all(np.diff(np.clip(moved.breaks, *_ends(samples))) > 0):
            rest = moved.distances(samples)
            if rest @ rest < before:
                return moved, rest
    return None


def _ends(samples: LoopSamples) -> tuple[float, float]:
    return float(samples.twist.min()), float(samples.twist.max())


def with_breaks(breaks: FloatArray, samples: LoopSamples, steepness: FloatArray | float) -> tuple[JoinedLines, float]:
    """Joined lines with given breaks by linear least squares, and the sum of squares, weighted by both noises.

    ``steepness``: slope at each sample in N m/rad, by which noise of the twist becomes one of the torque.
    """
    twist = samples.twist
    centre = float((twist.min() + twist.max()) / 2)
    weight = 1 / np.hypot(samples.torque_noise, steepness * samples.twist_noise)
    piece = np.searchsorted(breaks, twist)
    span = float(np.ptp(twist))
    ramps = [np.maximum(twist - at, 0) - max(centre - at, 0) for at in breaks]
    columns = [np.ones_like(twist), *(ramp / span for ramp in (twist - centre, *ramps))]
    columns += [samples.sense * (piece == number) for number in range(len(breaks) + 1)]
    rows = np.stack(columns) * weight
    goal = samples.torque * weight
    # Normal equations: many places are tried, and columns of size 1 keep their digits.
    coefficients, *_ = np.linalg.lstsq(rows @ rows.T, rows @ goal, rcond=1e-12)
    rest = goal - coefficients @ rows
    count = len(breaks)
    slopes = np.cumsum(coefficients[1 : 2 + count]) / span
    lines = JoinedLines(centre, float(coefficients[0]), slopes, np.asarray(breaks), coefficients[2 + count :])
    return lines, float(rest @ rest)


def _longer(lines: JoinedLines, samples: LoopSamples, shortest: int) -> JoinedLines | None:
    """Lines with one more break, at the best of some places, before refinement; None where no piece is long enough."""
    steepness = lines.slopes[lines.piece(samples.twist)]
    ordered = np.sort(samples.twist)
    best: tuple[JoinedLines, float] | None = None
    for at in np.linspace(*_ends(samples), PLACES + 2)[1:-1].tolist():
        breaks = np.sort(np.r_[lines.breaks, at])
        counts = np.diff(np.searchsorted(ordered, breaks), prepend=0, append=len(ordered))
        if counts.min() >= shortest:
            broken = with_breaks(breaks, samples, steepness)
            best = broken if best is None or broken[1] < best[1] else best
    return None if best is None else best[0]


def joined_lines(samples: LoopSamples, cycles: int) -> tuple[JoinedLines, bool]:
    """Joined lines with as many pieces as an F test finds, and whether the line asks for more than are looked for.

    Each break brings three numbers: its place, a slope and a friction torque. A break alone may bring little where
    two bring much, as at free play between two flanks: the last number of breaks that passes counts.
    """
    from scipy.special import fdtrc

    step = max(1, len(samples.twist) // THINNED)
    seen = samples.chosen(slice(None, None, step))
    shortest = max(4, SHORTEST * cycles // step)
    straight, _ = with_breaks(np.empty(0), seen, 0.0)
    kept, squares = fitted(straight, seen)
    lines, passed = kept, False
    for _ in range(MOST_BREAKS):
        longer = _longer(lines, seen, shortest) if len(lines.breaks) - len(kept.breaks) < FAILED else None
        if longer is None:
            break
        lines, fewer = fitted(longer, seen)
        counts = np.bincount(lines.piece(seen.twist), minlength=len(lines.slopes))
        # F = (squares saved/numbers more)/(squares left/degrees of freedom)
        more, freedom = 3 * (len(lines.breaks) - len(kept.breaks)), len(seen.twist) - len(lines.numbers())
        passed = bool(
            counts.min() >= shortest
            and freedom > 0
            and fdtrc(more, freedom, max(squares - fewer, 0.0) / more / (fewer / freedom)) < SIGNIFICANCE
        )
        if passed:
            kept, squares = lines, fewer
    return kept, passed
