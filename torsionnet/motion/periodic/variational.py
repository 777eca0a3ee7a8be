"""Monodromy of a periodic motion by the variational equation along its harmonics.

With the slopes s_l(t) of the laws along the motion a small change x of the state follows

    x' = (A + sum_l a_l s_l(t) b_l^T) x,

stepped by the method of Magnus of fourth order (S. Blanes et al., The Magnus expansion and some of its applications,
Physics Reports 470, 2009). Steps end where a law passes to another piece, so that slopes are smooth within each. Where
its torque jumps by dT there, the change passes a_l dT b_l^T / g' besides. Friction behind a spring k has a state of its
own, the twist d at which it last stopped slipping: it holds k (b^T x - d) while it sticks, d = b^T x as a slip ends.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.contact_form import contact_form, relative_form
from torsionnet.motion.motion_plant import Drive, Layout, MotionPlant
from torsionnet.motion.periodic.contact_passage import without_turning
from torsionnet.motion.periodic.law_forces import PieceForce, SliderForce
from torsionnet.motion.periodic.periodic_problem import PeriodicMotion, PeriodicProblem, over_time, samples

STEPS_PER_HARMONIC, FEWEST_STEPS = 16, 512
"""Steps of Magnus's method in a period over the harmonics, and at least."""
AT_ONCE = 1024
"""Times at which harmonics are summed together."""
SPRING = 1e-6
"""Share by which the stiffness before friction may differ from that of the plant: rounding of its receptances."""


@dataclass(frozen=True, eq=False)
class LawCourse:
    """Motion of a law with harmonics x (H + 1,) of omega in rad/s, about a mean rate in rad/s."""

    x: ComplexArray
    omega: float
    mean_rate: float

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Motions (n,) and rates (n,) at times in s."""
        k = np.arange(len(self.x))
        both = np.stack([self.x, 1j * self.omega * k * self.x], axis=1)
        parts = [
            (np.exp(1j * self.omega * times[start : start + AT_ONCE, None] * k) @ both).real
            for start in range(0, len(times), AT_ONCE)
        ]
        motion, rate = np.concatenate(parts).T
        return motion, rate + self.mean_rate

    def at_one(self, time: float) -> tuple[float, float]:
        motion, rate = self.at(np.array([time]))
        return float(motion[0]), float(rate[0])


@dataclass(frozen=True, eq=False)
class PieceChange:
    """Time in s at which a law passes to another piece, with its torque jump over the rate; ``grips``: a slip ends."""

    time: float
    law: int
    jump: float = 0.0
    grips: bool = False


def variational_monodromy(problem: PeriodicProblem, motion: PeriodicMotion) -> FloatArray:
    """Monodromy of a motion without what turns freely.

    Raises
    ------
    SolveError
        A law acts where nothing has inertia.
    UsageError
        The plant has no states.
    """
    bare, at, A, entry, angles, rates, refresh = _around_laws(problem)
    sliders = [law for law, force in enumerate(problem.forces) if isinstance(force, SliderForce)]
    n = len(A)
    A, entry = np.pad(A, (0, len(sliders))), np.pad(entry, ((0, len(sliders)), (0, 0)))
    over_states = np.pad(angles, ((0, 0), (0, len(sliders))))
    over_rates = np.pad(rates, ((0, 0), (0, len(sliders))))
    held = {law: n + number for number, law in enumerate(sliders)}
    for law, place in held.items():
        over_states[law, place] = -1.0

    speed = problem.drive.speed(motion.parameter)
    courses = [
        LawCourse(motion.x[:, law], motion.omega, problem.plant.turning[law] * speed)
        for law in range(len(problem.forces))
    ]
    period = 2 * math.pi / motion.omega
    changes, grips = [], {}
    for law, (force, course) in enumerate(zip(problem.forces, courses, strict=True)):
        if isinstance(force, PieceForce):
            changes += list(_piece_changes(law, force, course, motion.harmonics))
        elif isinstance(force, SliderForce):
            grips[law] = list(_stretches_held(force, course, motion.harmonics))
            changes += [PieceChange(t % period, law, grips=True) for t, _ in grips[law]]
            changes += [PieceChange(t % period, law) for _, t in grips[law]]
    count = max(FEWEST_STEPS, STEPS_PER_HARMONIC << (motion.harmonics - 1).bit_length())
    times = np.union1d(np.linspace(0.0, period, count + 1), [change.time for change in changes])
    h = np.diff(times)[:, None, None]

    def matrices(share: float) -> FloatArray:
        """A(t) at a place from 0 to 1 in every step."""
        inside = times[:-1] + share * np.diff(times)
        total = np.repeat(A[None], len(inside), axis=0)
        for law, (force, course) in enumerate(zip(problem.forces, courses, strict=True)):
            x, rate = course.at(inside)
            rate_slope = None
            if isinstance(force, SliderForce):
                slope = force.stiffness * _is_held(inside, grips[law], period)
            elif isinstance(force, PieceForce):
                _, slope, rate_slope, _ = force.acting(x, rate if force.needs_rate else None)
            else:
                answer = force.answer_to(x, rate if force.needs_rate else None)
                slope, rate_slope = answer.slope, answer.rate_slope
            change = slope[:, None] * over_states[law]
            if rate_slope is not None:
                change = change + rate_slope[:, None] * over_rates[law]
            total += entry[:, law][:, None] * change[:, None, :]
        return total

    # A(t) at the two Gauss points of every step
    first, second = (matrices(0.5 + sign * math.sqrt(3) / 6) for sign in (-1, 1))
    exponents = h / 2 * (first + second) - math.sqrt(3) / 12 * h**2 * (first @ second - second @ first)
    # what has no inertia may begin with any rate
    product = scipy.linalg.block_diag(refresh, np.eye(len(sliders)))
    following = sorted(changes, key=lambda change: change.time)
    for time, step in zip(times[1:], np.asarray(scipy.linalg.expm(exponents)), strict=True):
        product = step @ product
        while following and following[0].time <= time:
            change = following.pop(0)
            if change.grips:
                product[held[change.law]] = over_states[change.law, :n] @ product[:n]
            elif change.jump:
                product += change.jump * np.outer(entry[:, change.law], over_states[change.law] @ product)
    return without_turning(product, bare, at)


def _around_laws(
    problem: PeriodicProblem,
) -> tuple[MotionPlant, Layout, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Plant without laws: A (n, n), entries (n, n_laws) of torques, twists and rates (n_laws, n), refresh (n, n)."""
    plant = problem.plant
    bare = replace(plant.in_time.plant, laws=())
    n_q, n_laws = plant.rows.shape[1], len(plant.laws)
    drive = Drive(-plant.rows.T, (), 0, np.zeros((0, 0)), np.zeros((n_laws, 0)))
    at = Layout(n_q, sum(len(action.F) for action in bare.actions), 0, n_laws)
    form = relative_form(bare, at, contact_form(bare, (), (), drive))
    own = slice(0, 2 * n_q + at.n_c)
    position, speed, _ = form.motion
    # A spring before friction gives way to its torque, x = g + T/k; nothing else may.
    gives_way = plant.rows @ position[:, at.u] + np.diag([force.yielding for force in problem.forces])
    if (np.abs(gives_way) > SPRING * max(force.yielding for force in problem.forces)).any():
        raise SolveError("a law acts where nothing has inertia", kind="unsupported-law")
    twists, rates = plant.rows @ position[:, own], plant.rows @ speed[:, own]
    return bare, at, form.A[own, own], form.A[own, at.u], twists, rates, form.refresh[own, own]


def _located(value: Callable[[float], float], low: float, high: float) -> float:
    """Time between two at which a value passes zero; the later one where it keeps its sign."""
    return float(scipy.optimize.brentq(value, low, high)) if value(low) * value(high) < 0 else high


def _piece_changes(law: int, force: PieceForce, course: LawCourse, harmonics: int) -> Iterator[PieceChange]:
    """Yield the changes of a law of straight pieces from one to another."""
    n = samples(harmonics)
    h = 2 * math.pi / course.omega / n
    k = np.arange(len(course.x))
    rate = over_time(1j * course.omega * k * course.x, n) + course.mean_rate if force.needs_rate else None
    pieces = force.acting(over_time(course.x, n), rate)[3]

    def at(time: float) -> tuple[float, int, float]:
        x, rate = course.at(np.array([time]))
        torque, _, _, piece = force.acting(x, rate if force.needs_rate else None)
        return float(torque[0]), int(piece[0]), float(rate[0])

    def acts(time: float, piece: int) -> float:
        return 1.0 if at(time)[1] == piece else -1.0

    for place in np.flatnonzero(pieces != np.roll(pieces, -1)).tolist():
        time = _located(partial(acts, piece=int(pieces[place])), place * h, (place + 1) * h)
        # torques just beside it: contacts with damping begin with a jump
        (earlier, _, rate_there), (later, _, _) = at(time - 1e-6 * h), at(time + 1e-6 * h)
        yield PieceChange(time, law, (later - earlier) / rate_there if rate_there else 0.0)


def _stretches_held(force: SliderForce, course: LawCourse, harmonics: int) -> Iterator[tuple[float, float]]:
    """Yield begin and end in s of stretches in which friction behind a spring sticks, none where it does all along."""
    n = samples(harmonics)
    h = 2 * math.pi / course.omega / n
    answer = force.answer_to(over_time(course.x, n), None)
    if answer.slope.all():
        return

    def beyond(time: float, wanted: float) -> float:
        return course.at_one(time)[0] - wanted

    for mask, turn in answer.since:
        # From where the twist turns back the torque falls from one bound to the other, or comes back to the first.
        begin = _located(lambda t: course.at_one(t)[1], (turn - 1) * h, (turn + 1) * h)
        count = int(mask[(turn + np.arange(n)) % n].argmin())  # the first sample that slips again
        there = float(answer.torque[(turn + count) % n] - answer.torque[turn]) / force.stiffness
        wanted = course.at_one(begin)[0] + there
        last = (turn + count) * h
        yield begin, _located(partial(beyond, wanted=wanted), last - h, last)


def _is_held(times: FloatArray, held: list[tuple[float, float]], period: float) -> FloatArray:
    """Share (n,) of the spring before friction that acts at times in s: 1 where it sticks, 0 where it slips."""
    if not held:
        return np.ones(len(times))
    sticks = np.zeros(len(times))
    for begin, end in held:
        sticks[(times - begin) % period < end - begin] = 1.0
    return sticks
