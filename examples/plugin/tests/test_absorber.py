"""The absorber splits the resonance to which it is tuned."""

import math

from torsionnet_absorber import Absorber

import torsionnet as tn


def test_two_natural_frequencies():
    """Mass ratio mu = 0.1, tuned to the main system: (omega/omega_n)^2 = 1 + mu/2 -+ sqrt(mu + mu^2/4)."""
    main = tn.Inertia("disc", node="hub", inertia=0.2), tn.Spring("shaft", nodes=("hub", "ground"), stiffness=5000)
    omega = math.sqrt(5000 / 0.2)
    ring = Absorber("ring", node="hub", inertia=0.02, frequency=omega / (2 * math.pi))
    frequencies = tn.Drivetrain("absorber", [*main, ring]).modes().undamped_natural_frequencies
    for frequency, sign in zip(frequencies, (-1, 1), strict=True):
        expected = omega * math.sqrt(1 + 0.05 + sign * math.sqrt(0.1 + 0.0025))
        assert math.isclose(2 * math.pi * frequency, expected, rel_tol=1e-9)
