"""Entries of a test bench for its excitation, exciter, sensors and data acquisition. The rig itself is a drivetrain."""

from torsionnet.model.bench.parts import Acquisition, Encoder, Exciter, Transducer
from torsionnet.model.bench.plan import Plan

__all__ = ["Acquisition", "Encoder", "Exciter", "Plan", "Transducer"]
