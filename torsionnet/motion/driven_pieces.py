"""Motion over time of a drivetrain with laws of straight pieces under torques of lines and waves, exact between events.

Between the breaks of the torques waves are generators w' = F w among the states, so that exponentials advance them with
the motion. Breaks that no sample hits are reached by steps of their own length.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.model.channels import Input
from torsionnet.motion.contact_states import Contact, ContactStates, FinerStepError
from torsionnet.motion.driving import Driving, Stretch
from torsionnet.motion.motion_over_time import MotionOverTime
from torsionnet.motion.motion_record import MotionRecord
from torsionnet.motion.piece_system import PieceMotion
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK
from torsionnet.motion.smooth_laws import SplitPlant
from torsionnet.motion.state_layout import Drive, Layout
from torsionnet.motion.step_length import first_rates, steps_of
from torsionnet.motion.step_matrices import BLOCK
from torsionnet.signals.energy_balance import AnyBalance, DeferredBalance, EnergyBalance


@dataclass(frozen=True, eq=False)
class Generators:
    """Generators w' = F w of the waves in all entries of u, which S adds to them.

    Those of an exponent s = a + jb are the real and imaginary parts of A exp(s (t - t_0)).
    """

    kinds: tuple[tuple[int, complex], ...]
    F: FloatArray
    S: FloatArray

    def at(self, stretch: Stretch, time: float) -> FloatArray:
        """States (n_w,) of the generators at a time of a stretch; waves of others stand still at zero."""
        found = np.zeros(2 * len(self.kinds))
        for one in stretch.waves:
            place = 2 * self.kinds.index((one.entry, one.exponent))
            wave = one.amplitude * np.exp(one.exponent * (time - stretch.start))
            found[place : place + 2] += wave.real, wave.imag
        return found


def generators_of(stretches: Sequence[Stretch], n_u: int) -> Generators:
    """Generators of all waves of stretches, with ``n_u`` entries of u."""
    kinds = tuple(dict.fromkeys((one.entry, one.exponent) for stretch in stretches for one in stretch.waves))
    F, S = np.zeros((2 * len(kinds), 2 * len(kinds))), np.zeros((n_u, 2 * len(kinds)))
    for number, (entry, exponent) in enumerate(kinds):
        own = slice(2 * number, 2 * number + 2)
        F[own, own] = [[exponent.real, -exponent.imag], [exponent.imag, exponent.real]]
        S[entry, 2 * number] = 1.0
    return Generators(kinds, F, S)


@dataclass(frozen=True)
class _Run:
    """Steps of one length from ``start`` in s: ``n`` intervals of k steps, the first point being sample ``sample``.

    Without samples ``sample`` is -1; with ``alone`` only the first point is one.
    """

    start: float
    interval: float
    n: int
    sample: int
    alone: bool = False


def simulate_pieces(
    split: SplitPlant,
    readings: Sequence[Functional],
    inputs: Sequence[Input],
    driving: Driving,
    z0: FloatArray,
    contact: Contact | None = None,
    refinement: int = 1,
) -> MotionOverTime:
    """Motion of a plant with laws of straight pieces from a state z0 = (q, q', controllers, ...) in SI units.

    The parameters are those of :func:`.smooth_system.simulate_smooth`; with ``refinement`` steps are so many times
    shorter.

    Raises
    ------
    UsageError
        Parts that stick in a loop, massless nodes whose motion nothing fixes, or too many steps.
    SolveError
        Too many events, or a row that leaves its curve.
    """
    plant = split.plant
    columns = np.array([plant.assembly.rows_of(channel.row)[0] for channel in inputs]).reshape(len(inputs), -1).T
    n_in, n_scales = columns.shape[1], len(split.scales)
    cuts = [0.0, *driving.breaks, driving.duration]
    stretches = [driving.straight(start, end) for start, end in pairwise(cuts)]
    made = generators_of(stretches, n_in + n_scales)
    scale_of = tuple(-1 if one < 0 else n_in + one for one in split.scale_of)
    drive = Drive(columns, scale_of, n_scales, made.F, made.S)
    at = Layout(len(columns), sum(len(one.F) for one in plant.actions), len(made.F), drive.n_u)
    z = np.zeros(at.size)
    own = slice(0, 2 * at.n_q + at.n_c)
    z[own], z[at.one] = z0[own], 1.0
    states = ContactStates(plant, split.phases, drive, at, relative=True)
    rates = first_rates(states, split.phases)
    march = _DrivenMarch(states, readings, inputs, driving, stretches, made)
    while True:
        try:
            return march.whole(z, contact, rates, refinement)
        except FinerStepError as finer:
            rates = (max(rates[0], finer.rates[0]), max(rates[1], finer.rates[1]))


@dataclass(frozen=True, eq=False)
class _DrivenMarch:
    states: ContactStates
    readings: Sequence[Functional]
    inputs: Sequence[Input]
    driving: Driving
    stretches: Sequence[Stretch]
    generators: Generators

    def whole(
        self, z: FloatArray, contact: Contact | None, rates: tuple[float, float], refinement: int
    ) -> MotionOverTime:
        """Motion from a state z to the last sample."""
        driving, at = self.driving, self.states.at
        found = MotionOverTime(np.zeros((len(self.readings), driving.n)), (), EnergyBalance(0.0, 0.0))
        k, n_sub = steps_of(rates, 1 / driving.rate, driving.n, refinement)
        length = jumped = 0.0
        energy: float | None = None
        parts: list[MotionOverTime] = []
        for stretch in self.stretches or [driving.straight(0.0, 0.0)]:
            for run in self._runs(stretch):
                steps = max(1, math.ceil(run.interval * driving.rate * k - SAMPLE_SLACK))
                h = run.interval / steps
                if h != length:
                    for one in parts:
                        one.energy.left_over  # noqa: B018  works are those of the steps before
                    self.states.with_steps(h, n_sub)
                    length = h
                drive = self._grid(stretch, run, steps)
                motion = PieceMotion(self.states, drive, steps, run.n * steps, run.start)
                record = MotionRecord(self.states, self.readings, self.inputs, run.n + 1, steps, drive)
                z[at.w] = self.generators.at(stretch, run.start)
                parts.append(motion.whole(z, record, contact))
                z, contact = motion.end, motion.contact
                if energy is not None:  # a torque that jumps moves at once what has no inertia
                    jumped += motion.energies[0] - energy
                energy = motion.energies[1]
                if run.sample >= 0:
                    last = 1 if run.alone else run.n + 1
                    found.values[:, run.sample : run.sample + last] = parts[-1].values[:, :last]
                elif run.n:
                    number = round((run.start + run.interval) * driving.rate)
                    if abs((run.start + run.interval) * driving.rate - number) < SAMPLE_SLACK:
                        found.values[:, number] = parts[-1].values[:, -1]
        events = tuple(event for part in parts for event in part.events)
        balances = [*(part.energy for part in parts), EnergyBalance(jumped, jumped)]
        return MotionOverTime(found.values, events, DeferredBalance(lambda: added_up(balances)))

    def _runs(self, stretch: Stretch) -> Iterator[_Run]:
        """Runs of a stretch: to the first sample in it, from there to the last one, and on to its end."""
        rate = self.driving.rate
        first, last = math.ceil(stretch.start * rate - SAMPLE_SLACK), math.floor(stretch.end * rate + SAMPLE_SLACK)
        if last < first:
            yield _Run(stretch.start, stretch.end - stretch.start, 1, -1)
            return
        if first - stretch.start * rate > SAMPLE_SLACK:
            yield _Run(stretch.start, first / rate - stretch.start, 1, -1)
        if last > first or stretch.end == stretch.start:
            yield _Run(first / rate, 1 / rate, last - first, first)
        if stretch.end * rate - last > SAMPLE_SLACK:
            yield _Run(last / rate, stretch.end - last / rate, 1, last, alone=True)

    def _grid(self, stretch: Stretch, run: _Run, steps: int) -> FloatArray:
        """Straight parts of u (n_points, n_u) at the grid points of a run, and beyond it as far as a block reaches."""
        numbers = np.arange(run.n * steps + BLOCK + 2)
        passed = numbers * (run.interval / steps)
        lines = stretch.values[:, None] + stretch.slopes[:, None] * (run.start - stretch.start + passed)
        end = run.start + run.n * run.interval
        times = np.minimum(run.start + passed, end)
        if run.sample >= 0 and not run.alone:  # exact at samples
            times = (run.sample + np.minimum(numbers / steps, run.n)) / self.driving.rate
        return np.ascontiguousarray((lines + self.driving.sampled(times)).T)


def added_up(balances: Sequence[AnyBalance]) -> EnergyBalance:
    """Energy balance of motions that follow each other."""
    lost: dict[str, float] = {}
    for one in balances:
        for owner, value in one.dissipated.items():
            lost[owner] = lost.get(owner, 0.0) + value
    return EnergyBalance(sum(one.supplied for one in balances), sum(one.stored for one in balances), lost)
