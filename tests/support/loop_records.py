"""Records of slow loops of torque over twist with known truth, made without the package's calculations."""

from __future__ import annotations

import numpy as np

from torsionnet.signals import Recording, Signal

RATE = 400.0
"""Sampling rate in Hz of the records: 800 samples a cycle of 2 s."""
STAGES = ((460.0, 0.12), (1500.0, np.inf))
"""Stiffness in N m/rad of both stages, and the twist in rad up to which each reaches."""


def course(cycles: float, samples: int, *, sine: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Twist between -1 and 1, from the lowest on, and its sense: 1 where it rises and -1 where it falls."""
    turns = np.arange(round(cycles * samples)) / samples
    twist = -np.cos(2 * np.pi * turns) if sine else 1 - 2 * np.abs(2 * (turns % 1) - 1)
    return twist, np.where(turns % 1 < 0.5, 1.0, -1.0)


def staged(twist: np.ndarray, stages: tuple[tuple[float, float], ...] = STAGES) -> np.ndarray:
    """Torque in N m of a spring with stages, the same both ways, at twists in rad."""
    size, begin, torque = np.abs(twist), 0.0, np.zeros_like(twist)
    for stiffness, end in stages:
        torque = torque + stiffness * (np.clip(size, begin, end) - begin)
        begin = end
    return np.sign(twist) * torque


def loop_record(torque: np.ndarray, twist: np.ndarray, rate: float = RATE) -> Recording:
    """Recording of a torque T and a twist gamma."""
    return Recording((Signal("T", "torque", torque), Signal("gamma", "angle", twist)), rate, title="bench")


def stage_record(seed: int, *, walk: float = 0.0, step: float = 0.0, drift: float = 0.0) -> Recording:
    """Recording of 460 N m/rad to 0.12 rad, then 1500, friction 6 N m, +-0.25 rad, white torque noise 0.5 N m.

    Five cycles of 800 samples count behind the first. ``walk``: deviation of a random walk of the torque, N m a sample;
    ``step``: of the encoder, rad; ``drift``: of the torque, N m a cycle.
    """
    rng = np.random.default_rng(seed)
    twist, sense = course(7.6, 800)
    twist = 0.25 * twist
    torque = staged(twist) + 6.0 * sense + rng.normal(0, 0.5, len(twist))
    torque += np.cumsum(rng.normal(0, walk, len(twist))) if walk else 0.0
    torque += drift * np.arange(len(twist)) / 800
    if step:
        place = rng.uniform(0, step)
        twist = np.round((twist + place) / step) * step - place
    return loop_record(torque, twist)


def backlash_record(seed: int) -> Recording:
    """Recording of free play 0.5 deg, 20 000 N m/rad in contact, friction 1 N m, +-40 N m; noise 0.1 N m, 0.003 deg."""
    rng = np.random.default_rng(seed)
    gap = np.radians(0.5)
    twist, sense = course(7.6, 800)
    twist = (gap / 2 + 40 / 20000) * twist
    torque = 20000 * (twist - np.clip(twist, -gap / 2, gap / 2)) + sense + rng.normal(0, 0.1, len(twist))
    return loop_record(torque, twist + rng.normal(0, np.radians(0.003), len(twist)))


def arc_spring_record(samples: int = 4000) -> Recording:
    """Recording of slow loops of an arc spring at 3000 rpm, 20 +- 2 deg, by the closed form while coils are locked.

    k 700 N m/rad, m 0.9 kg, r 0.11 m, mu 0.12, psi 2.6; loaded once from nothing to 22 deg.
    """
    k, friction, arc, a = 700.0, 0.12, 2.6, np.radians(2.0)
    pressure = 0.9 * 0.11**2 * (3000 * np.pi / 30) ** 2 / arc  # C/psi
    e = friction * arc
    loaded = k * (np.radians(20.0) + a)
    # Loading from nothing: all coils move where u0 (exp(e) - 1 - e)/e is passed, then k gamma = u (1 - exp(-e))/e - u0.
    through = pressure * (np.exp(e) - 1 - e) / e
    assert loaded > through
    top = (loaded + pressure) * e / (1 - np.exp(-e))
    bottom = top * (1 - np.sqrt(k * e * 2 * a / top)) ** 2
    twist, sense = course(4.6, samples, sine=True)
    up = bottom * (1 + np.sqrt(k * e * a * (1 + twist) / bottom)) ** 2
    down = top * (1 - np.sqrt(k * e * a * (1 - twist) / top)) ** 2
    return loop_record(np.where(sense > 0, up, down) - pressure, np.radians(20.0) + a * twist)
