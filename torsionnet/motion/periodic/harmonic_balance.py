"""Harmonic balance over the motions of laws alone: residual, slopes and Newton's method.

With the receptances G = B D_0^-1 B^T of the condensed plant, the motion of law l at harmonic k is

    g_lk = s^p [ (B D_0^-1 F u)_lk - sum_m G_lm,k tau_mk ],   x = g + T/r,   tau = (1 + k_0/r) T(x) - k_0 x,

and the residual is x - g - T/r over the real and imaginary parts of x_k, k = 0 .. H. Torques come from samples by FFT,
their slopes as Toeplitz matrices of the Fourier coefficients of the slope over time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.law_forces import Force, LawAnswer, slope_matrix

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
