"""Periodic motion at one frequency by harmonic balance over the motions of laws alone.

With the receptances G = B D_0^-1 B^T of the condensed plant, the motion of law l at harmonic k is

    g_lk = s^p [ (B D_0^-1 F u)_lk - sum_m G_lm,k tau_mk ],   x = g + T/r,   tau = (1 + k_0/r) T(x) - k_0 x,

and the residual is x - g - T/r over the real and imaginary parts of x_k, k = 0 .. H. Torques come from samples by FFT,
their slopes as Toeplitz matrices of the Fourier coefficients of the slope over time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.law_forces import Force, LawAnswer, force_of, slope_matrix

# Harmonic balance over the motions of laws alone: residual, slopes and Newton's method.

SAMPLES_PER_HARMONIC, FEWEST_SAMPLES = 64, 4096
"""Samples in a period over the highest harmonic, and at least: where a torque bends, FFT misses its part by 1/N^2."""
CLOSE = 1e-9
"""Last step of Newton's method, over the motion: it doubles the digits, and what follows it is rounding."""
MOST_STEPS = 40
"""Most steps of Newton's method from one start."""
NOWHERE = 1e-8
"""Stiffness over k_0 that resists a mean twist in the slopes alone, so that these are never singular."""
HARDLY = 1e-4
"""Slope over r of the mean torque of friction that sticks: less would be lost in the rounding of the residual."""
SHORTEST = 1 / 64
"""Shortest part of a step of Newton's method that is tried."""


@dataclass(frozen=True, eq=False)
class HarmonicBalance:
    """Equations of one period: receptances at its harmonics, and the motions of laws without their torques.

    Attributes
    ----------
    forces : sequence of Force
    G : (H + 1, n_laws, n_laws) complex array
        Motion of each law per torque tau of another.
    driven : (H + 1, n_laws) complex array
        Motion of each law under the torques from outside alone.
    omega : float
        rad/s.
    references : (n_laws,) array
        Springs k_0 in N m/rad.
    rates : (n_laws,) array
        Mean rates of the laws in rad/s, besides those of the motions.
    """

    forces: Sequence[Force]
    G: ComplexArray
    driven: ComplexArray
    omega: float
    references: FloatArray
    rates: FloatArray

    @property
    def harmonics(self) -> int:
        return len(self.G) - 1

    def answers(self, x: ComplexArray) -> list[LawAnswer]:
        """Answers of the laws to motions with the harmonics x (H + 1, n_laws)."""
        n = samples(len(x) - 1)
        of_laws = []
        for number, force in enumerate(self.forces):
            values = over_time(x[:, number], n)
            s = 1j * self.omega * np.arange(len(x))
            rate = over_time(s * x[:, number], n) + self.rates[number] if force.needs_rate else None
            of_laws.append(force.answer_to(values, rate))
        return of_laws

    def taus(self, x: ComplexArray, torques: ComplexArray) -> ComplexArray:
        """Torques tau (H + 1, n_laws) that act beside the springs k_0."""
        yielding = np.array([force.yielding for force in self.forces])
        return np.asarray(torques * (1 + self.references * yielding) - self.references * x)

    def residual(self, x: ComplexArray) -> tuple[ComplexArray, list[LawAnswer], ComplexArray]:
        """Residual (H + 1, n_laws), the answers of the laws, and the harmonics of their torques."""
        answers, H = self.answers(x), self.harmonics
        torques = np.stack([harmonics_of(answer.torque, H) for answer in answers], axis=1)
        if H == 1:
            self._describe(x, torques)
        return self.left(x, torques), answers, torques

    def left(self, x: ComplexArray, torques: ComplexArray) -> ComplexArray:
        """Residual (H + 1, n_laws) of motions whose torques are known."""
        motion = self.driven - (self.G @ self.taus(x, torques)[:, :, None])[:, :, 0]
        return np.asarray(x - motion - torques * np.array([force.yielding for force in self.forces]))

    def _describe(self, x: ComplexArray, torques: ComplexArray) -> None:
        """Put the describing functions of laws that have one in the place of what samples give."""
        for number, force in enumerate(self.forces):
            described = force.describing(abs(x[1, number]), float(x[0, number].real), self.omega)
            if described is not None and not self.rates[number]:
                torques[:, number] = described.mean_torque, described.stiffness * x[1, number]

    def slopes(self, answers: Sequence[LawAnswer]) -> FloatArray:
        """Jacobian of the residual, over the packed harmonics of all laws."""
        H, n = self.harmonics, len(self.forces)
        identity = _identity(H)
        over_motions = np.zeros((n, H + 1, n, 2 * H + 1), dtype=complex)
        for m, (answer, force) in enumerate(zip(answers, self.forces, strict=True)):
            change = self.change(answer)
            tau = change * (1 + self.references[m] * force.yielding) - self.references[m] * identity
            # What stays within a gap may stand anywhere in it: a little stiffness leaves it where it is.
            tau[0, 0] += NOWHERE * self.references[m]
            over_motions[:, :, m] = self.G[:, :, m].T[:, :, None] * tau
            over_motions[m, :, m] += identity - force.yielding * change
            # Friction that sticks for good may hold any mean torque.
            over_motions[m, 0, m, 0] += HARDLY * force.power
        parts = np.concatenate([over_motions.real, over_motions.imag[:, 1:]], axis=1)
        return parts.reshape(n * (2 * H + 1), n * (2 * H + 1))

    def change(self, answer: LawAnswer) -> ComplexArray:
        """Harmonics (H + 1, 2 H + 1) of the torque of a law over those of its motion."""
        H = self.harmonics
        over_motion = slope_matrix(coefficients(answer.slope, H), H)
        if answer.rate_slope is not None:
            s = 1j * self.omega * np.arange(H + 1)
            over_rate = slope_matrix(coefficients(answer.rate_slope, H), H)
            # x' has the harmonics s x: its real part follows -w k Im x, its imaginary part w k Re x.
            real, imag = over_rate[:, 1 : H + 1], over_rate[:, H + 1 :]
            wk = s.imag[1:]
            over_motion[:, 1 : H + 1] += imag * wk
            over_motion[:, H + 1 :] -= real * wk
        n = len(answer.torque)
        for mask, at in answer.since:
            # Friction that sticks: the torque follows x less x where it last stopped slipping.
            stuck = 2 * coefficients(mask * answer.slope, H)[: H + 1]
            stuck[0] *= 0.5
            turn = np.exp(2j * np.pi * at / n * np.arange(1, H + 1))
            there = np.concatenate([[1.0], turn.real, -turn.imag])
            over_motion -= stuck[:, None] * there
        return over_motion


def samples(harmonics: int) -> int:
    """Number of samples in a period, a power of 2."""
    return max(FEWEST_SAMPLES, SAMPLES_PER_HARMONIC << max(harmonics - 1, 0).bit_length())


def over_time(x: ComplexArray, n: int) -> FloatArray:
    """Samples (n,) over a period of a motion with the one-sided harmonics x (H + 1,)."""
    spectrum = np.zeros(n // 2 + 1, dtype=complex)
    spectrum[: len(x)] = x * (n / 2)
    spectrum[0] = x[0].real * n
    return np.fft.irfft(spectrum, n)


def harmonics_of(values: FloatArray, harmonics: int) -> ComplexArray:
    """One-sided harmonics (H + 1,) of samples over a period."""
    amplitudes = np.fft.rfft(values)[: harmonics + 1] * (2 / len(values))
    amplitudes[0] *= 0.5
    return amplitudes


def coefficients(values: FloatArray, harmonics: int) -> ComplexArray:
    """Coefficients S_0 .. S_2H of samples s(t) = sum S_n e^(jnwt)."""
    return np.asarray(np.fft.rfft(values)[: 2 * harmonics + 1] / len(values))


def _identity(harmonics: int) -> ComplexArray:
    identity = np.zeros((harmonics + 1, 2 * harmonics + 1), dtype=complex)
    k = np.arange(1, harmonics + 1)
    identity[0, 0], identity[k, k], identity[k, harmonics + k] = 1, 1, 1j
    return identity


def packed(x: ComplexArray) -> FloatArray:
    """Real and imaginary parts of harmonics (H + 1, n_laws), law by law, as one vector."""
    return np.concatenate([x.real, x.imag[1:]]).T.ravel()


def unpacked(u: FloatArray, n_laws: int) -> ComplexArray:
    """Harmonics (H + 1, n_laws) of a packed vector."""
    parts = u.reshape(n_laws, -1).T
    H = len(parts) // 2
    x = parts[: H + 1].astype(complex)
    x[1:] += 1j * parts[H + 1 :]
    return x


def balance_of(
    plant: CondensedPlant, forces: Sequence[Force], omega: float, loads: ComplexArray, harmonics: int, speed: float
) -> HarmonicBalance:
    """Equations of a period at omega in rad/s under the harmonics (n, n_in) in N m of the torques on the inputs.

    ``speed`` in rad/s is that of the reference node.
    """
    receptances = plant.receptances(omega, range(harmonics + 1))
    amplitudes = np.zeros((harmonics + 1, loads.shape[1]), dtype=complex)
    count = min(len(loads), harmonics + 1)
    amplitudes[:count] = loads[:count]
    powers = receptances.s[:, None] ** np.array([force.power for force in forces])
    # Twists x = R D^-1 (B u - R^T tau), of laws over the rate with s before them.
    driven = powers * (plant.rows @ receptances.driven @ amplitudes[:, :, None])[:, :, 0]
    own = powers[:, :, None] * (plant.rows @ receptances.own)
    return HarmonicBalance(forces, own, driven, omega, plant.references, plant.turning * speed)


def newton(balance: HarmonicBalance, start: ComplexArray) -> ComplexArray | None:
    """Motions x (H + 1, n_laws) that solve the balance, from a start; None where Newton's method does not get there."""
    n = len(balance.forces)
    x = fitted(start, balance.harmonics)
    left, answers, _ = balance.residual(x)
    for _ in range(MOST_STEPS):
        try:
            step = unpacked(np.asarray(np.linalg.solve(balance.slopes(answers), packed(left))), n)
        except np.linalg.LinAlgError:
            return None
        if np.abs(step).max() <= CLOSE * max(np.abs(x).max(), np.abs(balance.driven).max()):
            return x - step
        # Damped Newton: the step is halved until the residual falls by a quarter of what the slopes promise.
        size, part = float(np.linalg.norm(left)), 1.0
        while True:
            moved = x - part * step
            following, answers, _ = balance.residual(moved)
            if np.linalg.norm(following) < size * (1 - part / 4) or part <= SHORTEST:
                break
            part /= 2
        x, left = moved, following
        if not np.isfinite(left).all():
            return None
    return None


def fitted(x: ComplexArray, harmonics: int) -> ComplexArray:
    """Motions with as many harmonics, the further ones zero or left out."""
    motions = np.zeros((harmonics + 1, x.shape[1]), dtype=complex)
    count = min(len(x), harmonics + 1)
    motions[:count] = x[:count]
    return motions


# Periodic motion at one frequency: the torques that drive it, its solution with as many harmonics as it needs.

Harmonics = int | Literal["auto"]

FIRST_HARMONICS, MOST_HARMONICS = 24, 600
"""Harmonics of the first solution, and at most."""
MOST_OF_STEPS = 250
"""Most harmonics in a period of the torques where laws have steps: over contact states the motion closes exactly."""
LEFT_OUT = 1e-6
"""Motion by the torques of all harmonics left out, over the peak to peak, from which more harmonics are taken."""
DRIVEN = 1e-3
"""Share of the largest motion under one harmonic of the torques, without laws, from which another one counts."""
LEAST = 0.1
"""Least size of a motion along branches, over that with springs in place of the laws."""
MORE = 1.6
"""Factor from one number of harmonics to the next."""


@dataclass(frozen=True, eq=False)
class PeriodicDrive:
    """Torques from outside over a parameter p, a frequency in Hz or a speed in rad/s.

    Attributes
    ----------
    omega : callable
        p -> fundamental circular frequency in rad/s, that of harmonic 1 of the torques.
    loads : callable
        p -> harmonics (n, n_in) in N m of the torques on the inputs, the mean first.
    speed : callable
        p -> mean speed in rad/s of the reference node; 0 over frequency.
    """

    omega: Callable[[float], float]
    loads: Callable[[float], ComplexArray]
    speed: Callable[[float], float] = lambda _: 0.0


@dataclass(frozen=True, eq=False)
class PeriodicMotion:
    """Motion with harmonics x (H + 1, n_laws) of the laws, at a parameter.

    ``omega`` in rad/s is that of its own period, ``subharmonics`` periods of the torques long. ``torques`` are the
    harmonics (H + 1, n_laws) of the laws, ``left_out`` what further harmonics move over the peak to peak.
    """

    parameter: float
    omega: float
    x: ComplexArray
    torques: ComplexArray
    subharmonics: int
    left_out: float

    @property
    def harmonics(self) -> int:
        return len(self.x) - 1


class PeriodicProblem:
    """Laws of motion of a plant under periodic torques, see :mod:`.harmonic_balance`.

    ``parameter_scale`` is the length of the parameter along branches, 0 for the parameter itself, and ``least_size``
    (n_laws,) that of motions at least. ``shares`` (n_laws,) of a parameter put laws over the twist in the place of
    their springs k_0, wholly where there is none. ``driven_to`` is the highest harmonic of the torques that counts.
    """

    parameter_scale = 0.0
    shares: Callable[[float], FloatArray] | None = None

    def __init__(self, plant: CondensedPlant, drive: PeriodicDrive, at: float, subharmonics: int = 1) -> None:
        self.plant, self.drive, self.subharmonics = plant, drive, subharmonics
        omega = drive.omega(at)
        self.forces: tuple[Force, ...] = tuple(
            force_of(law.owner, law.law, partial(plant.spring_before, place, omega), self._size(place, omega))
            for place, law in enumerate(plant.laws)
        )
        driven = self.balance(at, max(FIRST_HARMONICS, subharmonics * (len(drive.loads(at)) - 1))).driven
        moved = np.linalg.norm(driven[1:], axis=0)
        shares = np.abs(driven[::subharmonics]).max(axis=1)[1:]
        self.driven_to = 1 + int(np.flatnonzero(shares >= DRIVEN * shares.max(initial=0.0))[-1])
        self.least_size = LEAST * np.where(moved > 0, moved, np.abs(driven).max(initial=0.0) or 1.0)

    def _size(self, law: int, omega: float) -> float:
        """Torque in N m per motion of a law's row at omega in rad/s: that of the plant around it."""
        receptances = self.plant.receptances(omega, range(1, 2))
        own = abs(complex(self.plant.rows[law] @ receptances.own[0, :, law]))
        over_rate = self.plant.laws[law].law.curve.over == "rate"
        return 1 / (own * omega if over_rate else own)

    def with_subharmonics(self, count: int) -> PeriodicProblem:
        """Problem of motions that repeat after so many periods of the torques."""
        problem = copy(self)
        problem.subharmonics = count
        return problem

    def with_drive(self, drive: PeriodicDrive, parameter_scale: float = 0.0) -> PeriodicProblem:
        """Problem of the same laws under other torques, also over another parameter."""
        problem = copy(self)
        problem.drive, problem.parameter_scale = drive, parameter_scale
        return problem

    def balance(self, parameter: float, harmonics: int) -> HarmonicBalance:
        """Equations at a parameter."""
        omega, speed = self.drive.omega(parameter) / self.subharmonics, self.drive.speed(parameter)
        equations = balance_of(self.plant, self.forces, omega, self._loads(parameter), harmonics, speed)
        return equations if self.shares is None else replace(equations, G=equations.G * self.shares(parameter))

    def _loads(self, parameter: float) -> ComplexArray:
        """Harmonics (n, n_in) in N m of the torques over the period of the motions."""
        loads, nu = self.drive.loads(parameter), self.subharmonics
        spread = np.zeros((nu * (len(loads) - 1) + 1, loads.shape[1]), dtype=complex)
        spread[::nu] = loads
        return spread

    def solve(self, parameter: float, start: ComplexArray, harmonics: Harmonics = "auto") -> PeriodicMotion | None:
        """Periodic motion from a start, with the harmonics asked for or as many as it needs; None without one."""
        count = FIRST_HARMONICS * self.subharmonics if harmonics == "auto" else harmonics
        count = max(count, len(start) - 1) if harmonics == "auto" else count
        most = max(self.most_harmonics, count)
        x = start
        while True:
            balance = self.balance(parameter, count)
            solved = newton(balance, fitted(x, count))
            if solved is None:
                return None
            x = solved
            motion = self.motion(parameter, x, balance)
            if harmonics != "auto" or motion.left_out < LEFT_OUT or count >= most:
                return motion
            count = min(int(np.ceil(MORE * count)), most)

    def motion(self, parameter: float, x: ComplexArray, balance: HarmonicBalance) -> PeriodicMotion:
        """Solved motion, with what the harmonics left out would move."""
        _, answers, torques = balance.residual(x)
        H = len(x) - 1
        # What the torques of harmonics H + 1 to 2 H would twist, as a share of the swing: how far the series is cut.
        # Laws answer to one harmonic n of the torques at 3 n, 5 n and so on: the next of these is among them.
        most = H + max(H, 2 * self.driven_to * self.subharmonics)
        more = np.stack([harmonics_of(answer.torque, most)[H + 1 :] for answer in answers], axis=1)
        further = self.plant.receptances(balance.omega, range(H + 1, H + 1 + len(more)))
        behind = np.array([force.yielding if force.behind_spring else 0.0 for force in self.forces])
        moved = np.abs(np.einsum("kli,ki->kl", self.plant.rows @ further.own, more) - more * behind).sum(axis=0)
        # torques from outside at higher harmonics
        loads = self._loads(parameter)[H + 1 :]
        if loads.any():
            beyond = self.plant.receptances(balance.omega, range(H + 1, H + 1 + len(loads)))
            moved += np.abs(self.plant.rows @ beyond.driven @ loads[:, :, None]).sum(axis=(0, 2))
        # over the twist of friction and its spring together, since the friction may stand still
        twists = np.where(behind > 0, x, self._angles(x, torques, balance.omega))
        swing = np.array([np.ptp(over_time(own, samples(H))) for own in twists.T])
        left = float((moved / np.where(swing > 0, swing, 1.0)).max(initial=0.0))
        return PeriodicMotion(parameter, balance.omega, x, torques, self.subharmonics, left)

    @property
    def has_steps(self) -> bool:
        """Whether a law has steps, whose torque over time jumps where no spring stands before it."""
        return any(force.yielding and not force.behind_spring for force in self.forces)

    @property
    def most_harmonics(self) -> int:
        """Most harmonics that a motion takes to be right by them alone."""
        return MOST_OF_STEPS * self.subharmonics if self.has_steps else MOST_HARMONICS

    def moved_by_last(self, motion: PeriodicMotion) -> float:
        """Share of a swing by which the last harmonics moved a motion: of laws with steps, more than those left out."""
        count = int(motion.harmonics / MORE)
        balance = self.balance(motion.parameter, count)
        x = newton(balance, motion.x)
        if x is None:
            return 1.0
        fewer = fitted(self._angles(x, balance.residual(x)[2], motion.omega), motion.harmonics)
        twists = self._angles(motion.x, motion.torques, motion.omega)
        n = samples(motion.harmonics)
        own, apart = (np.array([np.ptp(over_time(column, n)) for column in of.T]) for of in (twists, twists - fewer))
        return float((apart / np.where(own > 0, own, 1.0)).max())

    def _angles(self, x: ComplexArray, torques: ComplexArray, omega: float) -> ComplexArray:
        """Harmonics of the twists of the laws in rad, of those over the rate without the mean."""
        s = 1j * omega * np.maximum(np.arange(len(x)), 1)[:, None]
        return np.asarray(self.twists(x, torques) / s ** np.array([force.power for force in self.forces]))

    def twists(self, x: ComplexArray, torques: ComplexArray) -> ComplexArray:
        """Harmonics (H + 1, n_laws) of the motions g of the laws, without what laws with steps have beside."""
        return np.asarray(x - torques * np.array([force.yielding for force in self.forces]))

    def beyond(self, motion: PeriodicMotion) -> str:
        """Message that a law is left: its motion lies beyond an end of its table; else empty."""
        n, k = samples(motion.harmonics), np.arange(motion.harmonics + 1)
        twists = self.twists(motion.x, motion.torques)
        for law, force, own in zip(self.plant.laws, self.forces, twists.T, strict=True):
            # of friction behind a spring, and of laws with steps over the rate, g itself is the rate
            rate = over_time(own if force.power else 1j * motion.omega * k * own, n)
            twist = np.zeros(n) if force.power else over_time(own, n)
            for place in (int(twist.argmin()), int(twist.argmax()), int(rate.argmin()), int(rate.argmax())):
                message = law.law.curve.left(float(twist[place]), float(rate[place]))
                if message:
                    return f"{law.owner}: {message}"
        return ""

    def largest_twist(self, motion: PeriodicMotion) -> tuple[str, float]:
        """Element of the law whose motion swings most, and its peak to peak, in rad of twists."""
        twists = self._angles(motion.x, motion.torques, motion.omega)
        swings = [float(np.ptp(over_time(own, samples(motion.harmonics)))) for own in twists.T]
        place = int(np.argmax(swings))
        return self.plant.laws[place].owner, swings[place]

    def coordinates(self, motion: PeriodicMotion) -> tuple[ComplexArray, ComplexArray]:
        """Harmonics (H + 1, n_q) of the coordinates in rad, and (H + 1, n_in) of the torques on the inputs in N m."""
        receptances = self.plant.receptances(motion.omega, range(motion.harmonics + 1))
        u = fitted(self._loads(motion.parameter), motion.harmonics)
        yielding = np.array([force.yielding for force in self.forces])
        # The receptances hold the springs k_ref in place of the laws: the laws add what exceeds k_ref x.
        tau = motion.torques * (1 + self.plant.references * yielding) - self.plant.references * motion.x
        q = np.einsum("kin,kn->ki", receptances.driven, u) - np.einsum("kil,kl->ki", receptances.own, tau)
        return q, u

    def readings(self, motion: PeriodicMotion, readings: Sequence[Functional]) -> ComplexArray:
        """Harmonics (H + 1, n_out) of sensors in SI units."""
        receptances = self.plant.receptances(motion.omega, range(motion.harmonics + 1))
        q, u = self.coordinates(motion)
        columns = []
        for reading in readings:
            over_q, over_laws, over_inputs = self.plant.reading(reading, receptances)
            columns.append((over_q * q).sum(axis=1) + motion.torques @ over_laws + u @ over_inputs)
        return np.stack(columns, axis=1)


def peak_to_peak(harmonics: ComplexArray) -> tuple[float, float]:
    """Lowest and highest value of a motion with one-sided harmonics (H + 1,), from parabolas through its samples."""
    values = over_time(harmonics, 4 * samples(len(harmonics) - 1))
    return -_top(-values), _top(values)


def _top(values: FloatArray) -> float:
    place = int(values.argmax())
    before, here, after = (float(values[(place + step) % len(values)]) for step in (-1, 0, 1))
    bend = before - 2 * here + after
    return here - (after - before) ** 2 / (8 * bend) if bend else here
