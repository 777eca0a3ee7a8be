# Written by `make generate`.
from torsionnet.bench.bench import Bench as Bench
from torsionnet.bench.bench import TurningTest as TurningTest
from torsionnet.bench.loading_bench import load_bench as load_bench
from torsionnet.bench.recorded_signal import ExciterOutput as ExciterOutput
from torsionnet.bench.wheel_turning import TrueFault as TrueFault
from torsionnet.entry_classes import Acquisition as Acquisition
from torsionnet.entry_classes import CoastDown as CoastDown
from torsionnet.entry_classes import DropOuts as DropOuts
from torsionnet.entry_classes import Encoder as Encoder
from torsionnet.entry_classes import Exciter as Exciter
from torsionnet.entry_classes import GivenSpeed as GivenSpeed
from torsionnet.entry_classes import Hum as Hum
from torsionnet.entry_classes import PitchErrors as PitchErrors
from torsionnet.entry_classes import Plan as Plan
from torsionnet.entry_classes import RadialVibration as RadialVibration
from torsionnet.entry_classes import RecordingSystem as RecordingSystem
from torsionnet.entry_classes import RunDown as RunDown
from torsionnet.entry_classes import RunUp as RunUp
from torsionnet.entry_classes import ShuntCalibration as ShuntCalibration
from torsionnet.entry_classes import SteadyPoints as SteadyPoints
from torsionnet.entry_classes import StrainGauge as StrainGauge
from torsionnet.entry_classes import ToothedWheel as ToothedWheel
from torsionnet.entry_classes import Transducer as Transducer
from torsionnet.entry_classes import ZeroDrift as ZeroDrift

__all__ = [
    "Acquisition",
    "Bench",
    "CoastDown",
    "DropOuts",
    "Encoder",
    "Exciter",
    "ExciterOutput",
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
    "TrueFault",
    "TurningTest",
    "ZeroDrift",
    "load_bench",
]
