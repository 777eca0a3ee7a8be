"""Entries of a test bench: excitation or motion, sensors, data acquisition. The rig itself is a drivetrain."""

from torsionnet.bench.plan.bench_motions import BenchMotion, CoastDown, GivenSpeed, RunDown, RunUp, SteadyPoints
from torsionnet.bench.plan.parts import Acquisition, DropOuts, Encoder, Exciter, Hum, RecordingSystem, Transducer
from torsionnet.bench.plan.plan import Plan
from torsionnet.bench.plan.strain_gauge import ShuntCalibration, StrainGauge, ZeroDrift
from torsionnet.bench.plan.toothed_wheel import PitchErrors, RadialVibration, ToothedWheel

__all__ = [
    "Acquisition",
    "BenchMotion",
    "CoastDown",
    "DropOuts",
    "Encoder",
    "Exciter",
    "GivenSpeed",
    "Hum",
    "PitchErrors",
    "Plan",
    "RadialVibration",
    "RecordingSystem",
    "RunDown",
    "RunUp",
    "ShuntCalibration",
    "SteadyPoints",
    "StrainGauge",
    "ToothedWheel",
    "Transducer",
    "ZeroDrift",
]
