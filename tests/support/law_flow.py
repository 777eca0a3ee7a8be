"""Flow of a plant with laws in full by DOP853, each of its pieces by itself from event to event."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

Guard = tuple[Callable[[float, float, float], float], int, int]
"""Value over twist, rate and slider that ends a piece, the sense in which it passes zero, and the piece that follows."""


@dataclass(frozen=True)
class Contact:
    """Contact beyond a gap on either side, max(0, k d + c d'); pieces -1, 0 and 1."""

    row: Sequence[float]
    gap: float
    stiffness: float
    damping: float = 0.0
    slides = False

    def _pushes(self, side: int, g: float, rate: float) -> float:
        return self.stiffness * (side * g - self.gap / 2) + self.damping * side * rate

    def piece(self, g: float, rate: float, slider: float) -> int:
        del slider
        return next((s for s in (1, -1) if s * g > self.gap / 2 and self._pushes(s, g, rate) > 0), 0)

    def torque(self, piece: int, g: float, rate: float, slider: float) -> float:
        del slider
        return piece * self._pushes(piece, g, rate) if piece else 0.0

    def guards(self, piece: int) -> list[Guard]:
        if piece:
            return [(lambda g, v, _: self._pushes(piece, g, v), -1, 0)]
        both = [lambda g, v, _, s=s: min(s * g - self.gap / 2, self._pushes(s, g, v)) for s in (1, -1)]
        return [(both[0], 1, 1), (both[1], 1, -1)]


@dataclass(frozen=True)
class Cubic:
    """Spring k g + k_3 g^3 with a damper."""

    row: Sequence[float]
    stiffness: float
    cubic: float
    damping: float = 0.0
    slides = False

    def piece(self, *_: float) -> int:
        return 0

    def torque(self, piece: int, g: float, rate: float, slider: float) -> float:
        del piece, slider
        return self.stiffness * g + self.cubic * g**3 + self.damping * rate

    def guards(self, piece: int) -> list[Guard]:
        del piece
        return []


@dataclass(frozen=True)
class Slider:
    """Friction of a torque behind a spring; pieces -1 and 1 slip, 0 sticks."""

    row: Sequence[float]
    stiffness: float
    most: float
    slides = True

    def piece(self, g: float, rate: float, slider: float) -> int:
        torque = self.stiffness * (g - slider)
        return next((s for s in (1, -1) if s * torque >= self.most * (1 - 1e-9) and s * rate > 0), 0)

    def torque(self, piece: int, g: float, rate: float, slider: float) -> float:
        del rate
        return piece * self.most if piece else self.stiffness * (g - slider)

    def guards(self, piece: int) -> list[Guard]:
        if piece:
            return [(lambda _, v, __: piece * v, -1, 0)]
        sticks = [lambda g, _, z, s=s: s * self.stiffness * (g - z) - self.most for s in (1, -1)]
        return [(sticks[0], 1, 1), (sticks[1], 1, -1)]


Law = Contact | Cubic | Slider


@dataclass(frozen=True, eq=False)
class Flow:
    """M q'' + C q' + K q + sum over laws of b T = sum over h of Re(F_h exp(j h w t)), the mean in ``loads[0]``.

    A state is (q, q', sliders). ``tolerance`` is that of a step over the state.
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    laws: Sequence[Law]
    loads: Sequence[Sequence[complex]]
    frequency: float
    tolerance: float = 1e-10

    def _motions(self, y: np.ndarray) -> list[tuple[float, float, float]]:
        n, sliders = len(self.M), iter(y[2 * len(self.M) :])
        return [
            (float(y[:n] @ law.row), float(y[n : 2 * n] @ law.row), float(next(sliders)) if law.slides else 0.0)
            for law in self.laws
        ]

    def _rates(self, t: float, y: np.ndarray, pieces: Sequence[int]) -> np.ndarray:
        n = len(self.M)
        turns = np.exp(2j * pi * self.frequency * t * np.arange(len(self.loads)))
        torques = (turns @ np.array(self.loads, dtype=complex)).real - self.C @ y[n : 2 * n] - self.K @ y[:n]
        sliders = []
        for law, piece, motion in zip(self.laws, pieces, self._motions(y), strict=True):
            torques -= np.array(law.row) * law.torque(piece, *motion)
            if law.slides:
                sliders.append(motion[1] if piece else 0.0)
        return np.concatenate([y[n : 2 * n], np.linalg.solve(self.M, torques), sliders])

    def stretches(self, y: np.ndarray, periods: int = 1) -> list:
        """Dense solutions from event to event over so many periods of the torques from a state on."""
        from scipy.integrate import solve_ivp

        pieces = [law.piece(*one) for law, one in zip(self.laws, self._motions(y), strict=True)]
        t, end, solutions = 0.0, periods / self.frequency, []
        while t < end:
            events, follows = [], []
            for place, (law, piece) in enumerate(zip(self.laws, pieces, strict=True)):
                for value, sense, following in law.guards(piece):

                    def event(_: float, y: np.ndarray, value=value, place=place) -> float:
                        return value(*self._motions(y)[place])

                    event.terminal, event.direction = True, sense
                    events.append(event)
                    follows.append((place, following))
            size = max(np.abs(y).max(), 1e-6)
            solutions.append(
                solve_ivp(
                    lambda t, y, pieces=tuple(pieces): self._rates(t, y, pieces), (t, end), y, method="DOP853",
                    rtol=self.tolerance, atol=1e-2 * self.tolerance * size, events=events, dense_output=True,
                )
            )  # fmt: skip
            t, y = float(solutions[-1].t[-1]), solutions[-1].y[:, -1]
            for (place, following), times in zip(follows, solutions[-1].t_events, strict=True):
                if len(times):
                    pieces[place] = following
        return solutions

    def end(self, y: np.ndarray, periods: int = 1) -> np.ndarray:
        """State after so many periods of the torques."""
        return self.stretches(y, periods)[-1].y[:, -1]

    def multipliers(self, y: np.ndarray, periods: int = 1) -> np.ndarray:
        """Multipliers by differences of the flow, the largest first."""
        sizes = np.repeat([np.abs(y[: len(self.M)]).max(), np.abs(y[len(self.M) : 2 * len(self.M)]).max()], len(self.M))
        steps = 1e-6 * np.append(sizes, np.full(len(y) - 2 * len(self.M), sizes[0]))
        columns = [
            (self.end(y + step, periods) - self.end(y - step, periods)) / (2 * step.max()) for step in np.diag(steps)
        ]
        multipliers = np.linalg.eigvals(np.array(columns).T)
        return multipliers[np.argsort(-np.abs(multipliers))]

    def extremes(self, y: np.ndarray, row: Sequence[float], periods: int = 1) -> tuple[float, float]:
        """Lowest and highest value of a row of the coordinates, from parabolas through samples."""
        tops = []
        for one in self.stretches(y, periods):
            values = np.array(row) @ one.sol(np.linspace(one.t[0], one.t[-1], 1000))[: len(row)]
            for course in (values, -values):
                place = int(course.argmax())
                low, here, high = course[max(place - 1, 0)], course[place], course[min(place + 1, 999)]
                inside = 0 < place < 999 and low + high < 2 * here
                tops.append(here + (high - low) ** 2 / (8 * (2 * here - low - high)) if inside else here)
        return -max(tops[1::2]), max(tops[::2])
