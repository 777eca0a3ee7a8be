"""Entries of a test bench: excitation, exciter, sensors, data acquisition. The rig itself is a drivetrain."""

from torsionnet.model.bench.parts import Acquisition, Encoder, Exciter, Transducer
from torsionnet.model.bench.plan import Plan

__all__ = ["Acquisition", "Encoder", "Exciter", "Plan", "Transducer"]
