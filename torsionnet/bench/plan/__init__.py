"""Entries of a test bench: excitation or motion, sensors, data acquisition. The rig itself is a drivetrain."""

from torsionnet.bench.plan.parts import (
    Acquisition,
    Creep,
    DropOuts,
    Encoder,
    Exciter,
    Hum,
    PitchErrors,
    RadialVibration,
    RecordingSystem,
    ShuntCalibration,
    StrainGauge,
    ToothedWheel,
    Transducer,
    ZeroDrift,
)
from torsionnet.bench.plan.plan import BenchMotion, CoastDown, GivenSpeed, Plan, RunDown, RunUp, SteadyPoints

__all__ = [
    "Acquisition",
    "BenchMotion",
    "CoastDown",
    "Creep",
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
