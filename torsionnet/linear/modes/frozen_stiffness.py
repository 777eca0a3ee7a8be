"""Modes with stiffness and damping over frequency, each of which is frozen at the frequency of the mode.

A vibration is a fixed point omega = |Im lambda(omega)| of the eigenvalue problem whose tables are read at omega; real
poles are those of the problem at rest. With N(omega) vibrations of the frozen problem above omega, N falls by one at a
fixed point, or rises by one where an eigenvalue follows the tables more quickly than omega: counts at both ends of a
range tell how many fixed points it holds. They are polished by inverse iteration on the matrix that reads its tables at
the eigenvalue itself, from vibrations of the problems at both ends; where fewer are met, the range is halved.

Modes are all rigid motions and real poles at rest and all fixed points at which N falls. There are at least as many as
eigenvalues at rest, and one more pair for each fixed point at which N rises, which is no mode. Counts between rows of
tables show where N rises and falls again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, Rows, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import (
    LARGE_SYSTEM,
    AnyArray,
    Subspaces,
    first_order,
    resisted_coordinates,
    restrict_to,
    subspaces,
)
from torsionnet.linear.dynamic_stiffness.row_algebra import unresisted_motions
from torsionnet.linear.modes.pencil import NotFoundError, Pencil, distinct, polished, refined
from torsionnet.linear.modes.spectrum import (
    Eigenpairs,
    Mode,
    Spectrum,
    on_real_axis,
    one_per_pair,
    refined_spectrum,
    solve_spectrum,
)

AT_REST = 1e-6
"""Frequency over that of the lowest row of a table up to which it is read at rest."""
NEAR_FIXED_POINT = 1e-7
"""Relative distance from an eigenvalue's frequency at which another one parts no ranges."""
SETTLED = 1e-9
"""Relative error up to which a polished eigenvalue is taken for a fixed point."""
NARROW, NARROW_RISING = 1e-11, 1e-3
"""Relative width of a range in which an eigenvalue that inverse iteration does not meet is taken as it is, and of one
in which only fixed points where N rises are left, which are no modes."""
COUNTING_RATIO, COUNTING_WORK = 1.06, 1e6
"""Ratio of frequencies at which vibrations above are counted, and bound on their number by the cube of coordinates."""
COUNTED_RANGE, FEWEST_COUNTS = 1e3, 8
"""Ratio of the ends of the range in which they are counted, and fewest counts in it; a large system has none."""
SLOPE_SHARE = 1e-3
"""Share of a range between rows of a table over which the slopes at its ends are taken."""
MOST_RANGES, MOST_RANGES_LARGE = 24, 2
"""Most ranges that rows of tables part, fewer in a large system, as each range takes an eigenvalue problem."""
MOST_PROBLEMS, MOST_PROBLEMS_LARGE = 400, 40
"""Most eigenvalue problems in which missing fixed points are sought, fewer in a large system."""


def next_to_rest(system: RowSystem) -> float:
    """Frequency in rad/s up to which all that depends on frequency is read at rest."""
    return AT_REST * min((2 * np.pi * f for _, law in system.dynamic for f in law.rows if f > 0), default=1.0)


def modes(system: RowSystem, *, undamped: bool = False) -> tuple[FloatArray, Eigenpairs, int]:
    """Rigid motions (n_q, n) and all other modes of a system with stiffness over frequency, eigenvalues in rad/s.

    Rigid motions and real poles are those at rest, without damping those next to rest; other modes vibrate, each at its
    own frequency. The third part is how many more vibrations there are than at rest.
    """
    problem = FrozenProblem(system, undamped)
    search = FixedPoints(problem)
    rest = problem.frozen_at(search.points[0] if undamped else 0.0)
    kept, real = one_per_pair(rest.spectrum)
    still = [] if undamped else [rest.mode(int(j)) for j in kept[real]]
    still = [replace(mode, value=complex(mode.value.real)) for mode in still]
    vibrations = search.all()
    more = len(vibrations) - len(problem.frequencies(search.points[0]))
    return rest.rigid, Eigenpairs.of_modes([*vibrations, *still], system.n_coordinates), more


@dataclass(frozen=True)
class FrozenSpectrum:
    """Eigenvalues and shapes of a system with constant coefficients, over the coordinates ``kept`` that it holds.

    ``candidates`` are the indices of its vibrations.
    """

    spectrum: Spectrum
    kept: tuple[int, ...]
    n_coordinates: int
    candidates: NDArray[np.intp]

    def over_all(self, shapes: Any) -> Any:
        """Shapes (n_q, n) over all coordinates, of which those that nothing holds stand still."""
        whole = np.zeros((self.n_coordinates, shapes.shape[1]), dtype=shapes.dtype)
        whole[list(self.kept)] = shapes
        return whole

    @property
    def rigid(self) -> FloatArray:
        """Shapes (n_q, n) of motions that no spring resists."""
        return np.asarray(self.over_all(self.spectrum.spaces.rigid))

    @property
    def frequencies(self) -> FloatArray:
        """Frequencies in rad/s of the vibrations."""
        return self.spectrum.values[self.candidates].imag

    def mode(self, index: int, error: float = 0.0, *, converged: bool = True) -> Mode:
        """Mode at an index of the spectrum, with an error if that is larger than its own."""
        shape = self.over_all(self.spectrum.shapes[:, [index]])[:, 0]
        worst = max(float(self.spectrum.errors[index]), error)
        return Mode(complex(self.spectrum.values[index]), shape, worst, converged)


@dataclass(frozen=True)
class FrozenProblem:
    """Eigenvalue problem of a system with stiffness and damping frozen at a frequency in rad/s. Solutions are kept.

    ``undamped`` leaves out all damping and losses.
    """

    system: RowSystem
    undamped: bool
    known: dict[bytes, FrozenSpectrum] = field(default_factory=dict)
    counted: dict[bytes, FloatArray] = field(default_factory=dict)
    frozen: dict[float, tuple[AnyArray, FloatArray]] = field(default_factory=dict)
    spaces: dict[tuple[bytes, bytes], tuple[Subspaces, tuple[int, ...], list[int], Rows]] = field(default_factory=dict)

    def coefficients(self, omega: float) -> tuple[AnyArray, FloatArray]:
        """Stiffness and damping (n_laws,) in N m/rad and N m s/rad of all laws at omega in rad/s."""
        if omega in self.frozen:
            return self.frozen[omega]
        stiffness, damping = self.system.frozen(omega)
        if not (np.all(np.isfinite(stiffness)) and np.all(np.isfinite(damping))):
            raise SolveError(
                f"a frequency-dependent stiffness is not finite at {omega:.6g} rad/s; correct its values there",
                kind="not-finite",
            )
        if np.any(stiffness.real < 0):
            text = f"a frequency-dependent stiffness has a negative real part at {omega:.6g} rad/s"
            raise SolveError(f"{text}; correct its values there", kind="no-solution")
        self.frozen[omega] = (stiffness.real, np.zeros_like(damping)) if self.undamped else (stiffness, damping)
        return self.frozen[omega]

    def key(self, omega: float) -> bytes:
        """Bytes of the coefficients at omega in rad/s, equal where the problem is the same."""
        stiffness, damping = self.coefficients(omega)
        return stiffness.tobytes() + damping.tobytes()

    def frozen_at(self, omega: float) -> FrozenSpectrum:
        """Eigenvalues and shapes of the problem frozen at omega in rad/s; at rest they are refined in many digits."""
        key = self.key(omega)
        if key not in self.known:
            stiffness, damping = self.coefficients(omega)
            system, stiffness, spaces, kept = self._reduced(stiffness, damping)
            spectrum = solve_spectrum(system, spaces, stiffness, undamped=self._is_lossless(stiffness, damping))
            spectrum = spectrum if omega else refined_spectrum(spectrum)
            candidates = _vibrations(spectrum.values)
            if np.iscomplexobj(stiffness):  # a real pole leaves the axis under losses; the count keeps it out
                elastic = stiffness.real.tobytes() + damping.tobytes()
                met = self.known.get(elastic)
                count = len(self._frequencies(stiffness.real, damping) if met is None else met.candidates)
                # Of the eigenvalues above the axis the least damped ones, as many as vibrate without losses.
                upper = np.flatnonzero(spectrum.values.imag > 0)
                decay = -spectrum.values[upper].real / np.abs(spectrum.values[upper])
                candidates = upper[np.argsort(decay, kind="stable")[:count]]
            self.known[key] = FrozenSpectrum(spectrum, kept, self.system.n_coordinates, candidates)
        return self.known[key]

    def frequencies(self, omega: float) -> FloatArray:
        """Frequencies in rad/s of the vibrations of the problem frozen at omega in rad/s, without their shapes."""
        stiffness, damping = self.coefficients(omega)
        if self.key(omega) in self.known or np.iscomplexobj(stiffness):
            return self.frozen_at(omega).frequencies
        return self._frequencies(stiffness, damping)

    @cached_property
    def _is_heavy(self) -> bool:
        return not unresisted_motions(self.system, self.system.inertia > 0).dimension

    def number_above(self, omega: float) -> int:
        """Number of vibrations of the problem frozen at omega in rad/s whose frequency is above omega."""
        stiffness, damping = self.coefficients(omega)
        # Where nothing feeds energy and all has inertia, |lambda|^2 = k/m of a complex shape is at most that undamped.
        bounded = np.isrealobj(stiffness) and np.all(damping >= 0) and self._is_heavy
        if bounded and self.key(omega) not in self.known:
            fastest = self._frequencies(stiffness, np.zeros_like(damping)).max(initial=0.0)
            if fastest <= omega:
                return 0
        return int(np.sum(self.frequencies(omega) > omega))

    def _frequencies(self, stiffness: AnyArray, damping: FloatArray) -> FloatArray:
        key = stiffness.tobytes() + damping.tobytes()
        if key not in self.counted:
            system, reduced, spaces, _ = self._reduced(stiffness, damping)
            form = first_order(system, spaces, reduced)
            if self._is_lossless(stiffness, damping):
                self.counted[key] = np.asarray(np.linalg.svd(form.coupling, compute_uv=False), dtype=float)
            else:
                values = np.linalg.eigvals(form.matrix).astype(complex)
                self.counted[key] = values[_vibrations(values)].imag
        return self.counted[key]

    def _is_lossless(self, stiffness: AnyArray, damping: FloatArray) -> bool:
        return self.undamped or not (np.iscomplexobj(stiffness) or np.any(damping))

    def _reduced(
        self, stiffness: AnyArray, damping: FloatArray
    ) -> tuple[RowSystem, AnyArray, Subspaces, tuple[int, ...]]:
        """System with constant coefficients, its stiffness and subspaces, without coordinates that nothing holds."""
        whole = replace(self.system, stiffness=stiffness.real.copy(), damping=damping, dynamic=())
        stiff, damped = stiffness != 0, damping != 0
        masks = (stiff.tobytes(), damped.tobytes())
        if masks not in self.spaces:
            kept = resisted_coordinates(whole, (whole.inertia > 0) | stiff | damped)
            part = restrict_to(whole, kept)
            laws = [law for law, row in enumerate(part.sparse_rows) if row]
            rows = Rows(tuple(part.sparse_rows[law] for law in laws), len(kept))
            part = RowSystem(rows, part.inertia[laws], part.damping[laws], part.stiffness[laws])
            self.spaces[masks] = subspaces(part, stiff[laws], damped[laws]), tuple(kept), laws, rows
        spaces, numbers, laws, rows = self.spaces[masks]
        some = RowSystem(rows, whole.inertia[laws], damping[laws], whole.stiffness[laws])
        return some, stiffness[laws], spaces, numbers


def _vibrations(values: ComplexArray) -> NDArray[np.intp]:
    return np.flatnonzero((values.imag > 0) & ~on_real_axis(values))


@dataclass(frozen=True)
class FixedPoints:
    """Search for the vibrations of a problem, each with the stiffness and damping at its own frequency."""

    problem: FrozenProblem
    solved: list[float] = field(default_factory=list)

    def all(self) -> list[Mode]:
        """Vibrations of the problem, range by range between rows of its tables."""
        ranges = [part for low, high in pairwise(self.points) for part in pairwise(self._turns(low, high))]
        return [mode for low, high in ranges for mode in self._between(low, high)]

    def _turns(self, low: float, high: float) -> list[float]:
        """Ends of a range in rad/s and points inside that part it, where the number of vibrations above turns.

        It rises and falls again where fixed points would go unseen, as near critical damping.
        """
        most = int(COUNTING_WORK / (len(self.points) * max(self.problem.system.n_coordinates, 1) ** 3))
        begin = max(low, high / COUNTED_RANGE)
        steps = min(max(most, FEWEST_COUNTS), math.ceil(math.log(high / begin) / math.log(COUNTING_RATIO)))
        if steps < 2 or self._is_large or self._is_constant(low, high) or self._is_gentle(low, high):
            return [low, high]
        points = [low, *np.geomspace(begin, high, steps + 1)[1:-1].tolist(), high]
        counts = [int(np.sum(self.problem.frequencies(point) > point)) for point in points]
        ends, sense = [low], 0
        # Where the number above goes on in the other sense, fixed points may hide each other.
        for place, (before, after) in enumerate(pairwise(counts)):
            if (after - before) * sense < 0:
                ends.append(self._parting(points[place]))
            sense = int(np.sign(after - before)) or sense
        return [*ends, high]

    def _is_gentle(self, low: float, high: float) -> bool:
        """Whether no vibration follows the tables of a range in rad/s more quickly than their frequency rises.

        Of one inertia ``omega = sqrt(k/J (1 - zeta^2))`` with ``zeta = c/(2 sqrt(k J))``: where frequency rises by a
        small share, omega changes by up to ``k'/2 + zeta^2/(1 - zeta^2) (c' + k'/2)`` times that share, k' and c' being
        the logarithmic slopes of k and c. Two real poles may become a vibration.
        """
        at = [low, *(row for row in self._rows if low < row < high), high]
        slopes = np.array([self._slopes(*ends) for pair in pairwise(at) for ends in (pair, pair[::-1])]).max(axis=0)
        values = [(self.problem.frozen_at(omega).spectrum.values, omega) for omega in (low, high)]
        if self.problem.undamped:
            return bool(slopes[0] < 2)
        if any(np.sum(on_real_axis(some) & (some != 0)) > 1 for some, _ in values):
            return False
        near = np.concatenate([some[(some.imag > low / 2) & (some.imag < 2 * high)] for some, _ in values])
        # zeta^2 / (1 - zeta^2) of the vibrations near the range
        squares = (near.real / np.abs(near)) ** 2
        with np.errstate(divide="ignore"):
            growth = (squares / (1 - squares)).max(initial=0.0)
        damping = slopes[1] + slopes[0] / 2
        # Either may be infinite beside a zero: of a pole next to real, and of a stiffness that begins at 0.
        return bool(slopes[0] / 2 + (growth * damping if growth and damping else 0.0) < 1)

    def _slopes(self, end: float, other: float) -> tuple[float, float]:
        """Largest logarithmic slopes of stiffness and damping over frequency, at one end of a range in rad/s."""
        step = math.log(other / end) * SLOPE_SHARE
        ends = zip(self.problem.coefficients(end), self.problem.coefficients(end * math.exp(step)), strict=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            rises = [np.where(here == there, 0.0, np.abs(np.log(np.abs(there / here)))) for here, there in ends]
        stiffness, damping = (float(rise.max(initial=0.0)) / abs(step) for rise in rises)
        return stiffness, damping

    @cached_property
    def pencil(self) -> Pencil:
        rates = self.problem.frozen_at(0.0).frequencies
        typical = float(np.median(rates)) if len(rates) else 1.0
        return Pencil.of(self.problem.system, undamped=self.problem.undamped, at=typical)

    @property
    def _is_large(self) -> bool:
        return self.problem.system.n_coordinates > LARGE_SYSTEM

    @cached_property
    def _rows(self) -> list[float]:
        """Frequencies in rad/s of the rows of all tables, rising, but for those at rest."""
        return sorted({2 * np.pi * f for _, law in self.problem.system.dynamic for f in law.rows if f > 0})

    @cached_property
    def points(self) -> list[float]:
        """Frequencies in rad/s that part the ranges of the search, from next to rest to above all vibrations."""
        lowest = next_to_rest(self.problem.system)
        top = max([*self._rows, lowest])
        # The upper end lies above every vibration of the problem frozen there.
        while self.problem.number_above(top) and (fastest := float(self.problem.frequencies(top).max())) >= top:
            top = 2 * fastest
        inside = [row for row in self._rows if lowest < row < top]
        # Rows of tables at which no coefficient changes part nothing.
        changing = [
            row
            for before, row, after in zip([lowest, *inside], inside, [*inside[1:], top], strict=False)
            if len({self.problem.key(at) for at in (before, row, after)}) > 1
        ]
        most = MOST_RANGES_LARGE if self._is_large else MOST_RANGES
        some = np.unique(np.linspace(0, len(changing) - 1, min(most, len(changing))).round().astype(int))
        return [self._parting(point) for point in (lowest, *(changing[place] for place in some), top)]

    def _parting(self, omega: float) -> float:
        """Frequency in rad/s next to omega at which no vibration of the problem frozen there has its own."""
        near = self.problem.frequencies(omega)
        while np.any(np.abs(near - omega) <= NEAR_FIXED_POINT * omega):
            omega *= 1 + 3 * NEAR_FIXED_POINT
            near = self.problem.frequencies(omega)
        return omega

    def _is_constant(self, low: float, high: float) -> bool:
        """Whether the problem is the same at all frequencies of a range in rad/s."""
        some = [low, *(row for row in self._rows if low < row < high), high]
        return len({self.problem.key(omega) for omega in some}) == 1

    def _between(self, low: float, high: float) -> Iterator[Mode]:
        """Yield the fixed points in a range of frequencies in rad/s."""
        problem = self.problem
        if self._is_constant(low, high):
            yield from self._as_frozen(low, high)
            return
        # N falls by one at each fixed point, and rises by one at the few where tables are steeper than omega.
        counted = problem.number_above(low) - problem.number_above(high)
        met: list[Mode] = []
        missing = 0
        # Starts from the vibrations in the range at both ends, then from those beside it.
        for end, beside in ((low, 0), (high, 0), (low, 1), (high, 1)):
            met += self._polished(end, low, high, max(missing, 0) * beside)
            values, shapes = np.array([mode.value for mode in met]), np.array([mode.shape for mode in met]).T
            met = [met[number] for number in distinct(values, shapes)]
            falling = self._where_the_count_falls(met)
            # counted = falling - rising, and those found that do not fall rise.
            missing = counted + len(met) - 2 * len(falling)
            if not missing:
                yield from falling
                return
        middle = self._parting((low + high) / 2)
        spent = len(self.solved) > (MOST_PROBLEMS_LARGE if self._is_large else MOST_PROBLEMS)
        narrow = high - low <= (NARROW if missing > 0 else NARROW_RISING) * high
        if narrow or spent or not low < middle < high:
            yield from falling
            yield from self._unsettled(low, high, missing)
            return
        self.solved.append(middle)
        yield from self._between(low, middle)
        yield from self._between(middle, high)

    def _as_frozen(self, low: float, high: float) -> Iterator[Mode]:
        """Yield the vibrations in a range of frequencies in rad/s in which no coefficient changes."""
        frozen = self.problem.frozen_at(low)
        inside = frozen.candidates[(frozen.frequencies > low) & (frozen.frequencies <= high)]
        if len(inside):
            wanted = np.isin(np.arange(len(frozen.spectrum.values)), inside)
            frozen = replace(frozen, spectrum=refined_spectrum(frozen.spectrum, wanted))
            yield from (frozen.mode(int(j)) for j in inside)

    def _polished(self, omega: float, low: float, high: float, beside: int) -> list[Mode]:
        """Fixed points in a range of frequencies in rad/s, from the vibrations that the problem has there at omega.

        Or from as many that are beside the range, where a number of them is given.
        """
        rates = self.problem.frequencies(omega)
        if not (beside and len(rates)) and not np.any((rates > low) & (rates <= high)):
            return []
        frozen, undamped, pencil = self.problem.frozen_at(omega), self.problem.undamped, self.pencil
        rates = frozen.frequencies
        apart = np.maximum(np.maximum(low - rates, rates - high), 0.0)
        inside = (rates > low) & (rates <= high)
        if beside:
            inside = ~inside & (apart <= np.sort(apart[~inside], kind="stable")[:beside].max(initial=0.0))
        some = frozen.candidates[inside]
        starts, shapes = frozen.spectrum.values[some], frozen.over_all(frozen.spectrum.shapes[:, some])
        try:
            with np.errstate(all="ignore"):
                # Each start to its fixed point, its law at its own frequency, equation (4.6); undamped in z = omega^2.
                begin = starts.imag**2 if undamped else starts
                z, shapes, errors = polished(pencil, begin, shapes / pencil.scale[:, None])
        except NotFoundError:
            return []
        z, shapes, errors = refined(pencil, z, pencil.scale[:, None] * shapes, errors)
        values = 1j * np.sqrt(np.maximum(z.real, 0.0)) if undamped else z
        # What has left the range belongs to another one, which finds it from nearer.
        met = (errors <= SETTLED) & (values.imag > low) & (values.imag <= high)
        return [Mode(complex(values[j]), shapes[:, j], float(errors[j])) for j in np.flatnonzero(met)]

    def _where_the_count_falls(self, modes: Sequence[Mode]) -> list[Mode]:
        """Fixed points at which the number of vibrations above falls, as it always does with constant stiffness."""
        if not modes:
            return []
        values = np.array([mode.value for mode in modes])
        shapes = np.array([mode.shape for mode in modes]).T / self.pencil.scale[:, None]
        if self.problem.undamped:
            values, shapes = values.imag**2, shapes.real
        # A mode whose frequency, with the stiffness at omega, rises slower than omega is overtaken by it: pull < 1.
        return [mode for mode, pull in zip(modes, self.pencil.pulls(shapes, values), strict=True) if pull < 1]

    def _unsettled(self, low: float, high: float, count: int) -> Iterator[Mode]:
        """Yield the vibrations next to a narrow range in rad/s, as many as are known to be there and were not met."""
        if count <= 0:
            return
        ends = [(omega, self.problem.frozen_at(omega)) for omega in (low, high)]
        near = sorted(
            (abs(float(frozen.spectrum.values[j].imag) - omega), place, int(j))
            for place, (omega, frozen) in enumerate(ends)
            for j in frozen.candidates
        )
        place = near[0][1]
        for off, _, j in [candidate for candidate in near if candidate[1] == place][:count]:
            yield ends[place][1].mode(j, off / high, converged=off <= SETTLED * high)
