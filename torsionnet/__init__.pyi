# Written by `make generate`.
from torsionnet import bench as bench
from torsionnet import campaign as campaign
from torsionnet import identification as identification
from torsionnet import io as io
from torsionnet import modal as modal
from torsionnet import plot as plot
from torsionnet import report as report
from torsionnet import response as response
from torsionnet import signals as signals
from torsionnet import study as study
from torsionnet import symbolic as symbolic
from torsionnet.bench import Bench as Bench
from torsionnet.bench import load_bench as load_bench
from torsionnet.campaign import load_campaign as load_campaign
from torsionnet.campaign import run_campaign as run_campaign
from torsionnet.core import units as units
from torsionnet.core.errors import Fault as Fault
from torsionnet.core.errors import MissingExtraError as MissingExtraError
from torsionnet.core.errors import ModelError as ModelError
from torsionnet.core.errors import Position as Position
from torsionnet.core.errors import SolveError as SolveError
from torsionnet.core.errors import TorsionnetError as TorsionnetError
from torsionnet.core.errors import TorsionnetWarning as TorsionnetWarning
from torsionnet.core.errors import UsageError as UsageError
from torsionnet.core.version import __version__ as __version__
from torsionnet.drivetrain import Drivetrain as Drivetrain
from torsionnet.entry_classes import OperatingPoint as OperatingPoint
from torsionnet.entry_classes import Parameter as Parameter
from torsionnet.entry_classes import ShortCircuitScenario as ShortCircuitScenario
from torsionnet.entry_classes import TorqueScenario as TorqueScenario
from torsionnet.identification import Fit as Fit
from torsionnet.identification import Measurement as Measurement
from torsionnet.identification import Unknown as Unknown
from torsionnet.identification import identify as identify
from torsionnet.loading import load as load
from torsionnet.loading import loads as loads
from torsionnet.model.channels import Input as Input
from torsionnet.model.channels import Sensor as Sensor
from torsionnet.model.damping import convert_damping as convert_damping
from torsionnet.model.elements import Element as Element
from torsionnet.model.elements.element_types import Belt as Belt
from torsionnet.model.elements.element_types import ChainDrive as ChainDrive
from torsionnet.model.elements.element_types import Clearance as Clearance
from torsionnet.model.elements.element_types import Clutch as Clutch
from torsionnet.model.elements.element_types import ConstantPowerLoad as ConstantPowerLoad
from torsionnet.model.elements.element_types import ContinuousShaft as ContinuousShaft
from torsionnet.model.elements.element_types import Controller as Controller
from torsionnet.model.elements.element_types import CrankThrow as CrankThrow
from torsionnet.model.elements.element_types import Damper as Damper
from torsionnet.model.elements.element_types import Differential as Differential
from torsionnet.model.elements.element_types import DualMassFlywheel as DualMassFlywheel
from torsionnet.model.elements.element_types import FinalDrive as FinalDrive
from torsionnet.model.elements.element_types import FlexibleCoupling as FlexibleCoupling
from torsionnet.model.elements.element_types import FluidCoupling as FluidCoupling
from torsionnet.model.elements.element_types import Friction as Friction
from torsionnet.model.elements.element_types import Gear as Gear
from torsionnet.model.elements.element_types import Gearbox as Gearbox
from torsionnet.model.elements.element_types import GridGenerator as GridGenerator
from torsionnet.model.elements.element_types import HystereticSpring as HystereticSpring
from torsionnet.model.elements.element_types import InductionMachine as InductionMachine
from torsionnet.model.elements.element_types import Inertia as Inertia
from torsionnet.model.elements.element_types import Lock as Lock
from torsionnet.model.elements.element_types import MassElastic as MassElastic
from torsionnet.model.elements.element_types import PendulumAbsorber as PendulumAbsorber
from torsionnet.model.elements.element_types import Planetary as Planetary
from torsionnet.model.elements.element_types import Propeller as Propeller
from torsionnet.model.elements.element_types import RigidCoupling as RigidCoupling
from torsionnet.model.elements.element_types import Shaft as Shaft
from torsionnet.model.elements.element_types import Spring as Spring
from torsionnet.model.elements.element_types import SpringDamper as SpringDamper
from torsionnet.model.elements.element_types import SynchronousMachine as SynchronousMachine
from torsionnet.model.elements.element_types import TabulatedSpring as TabulatedSpring
from torsionnet.model.elements.element_types import TorqueConverter as TorqueConverter
from torsionnet.model.elements.element_types import TunedDamper as TunedDamper
from torsionnet.model.elements.element_types import Tyre as Tyre
from torsionnet.model.elements.element_types import Vehicle as Vehicle
from torsionnet.model.elements.element_types import ViscousDamper as ViscousDamper
from torsionnet.model.files import library_benches as library_benches
from torsionnet.model.files import library_models as library_models
from torsionnet.report import write_report as write_report
from torsionnet.response import Channel as Channel
from torsionnet.response import Conventions as Conventions
from torsionnet.response import FrequencyResponse as FrequencyResponse
from torsionnet.response import FrequencyResponses as FrequencyResponses
from torsionnet.response import Modes as Modes
from torsionnet.solve import sensitivity as sensitivity
from torsionnet.solve.responses.grid import Adaptive as Adaptive
from torsionnet.study import load_study as load_study

__all__ = [
    "__version__",
    "Adaptive",
    "Belt",
    "Bench",
    "ChainDrive",
    "Channel",
    "Clearance",
    "Clutch",
    "ConstantPowerLoad",
    "ContinuousShaft",
    "Controller",
    "Conventions",
    "CrankThrow",
    "Damper",
    "Differential",
    "Drivetrain",
    "DualMassFlywheel",
    "Element",
    "Fault",
    "FinalDrive",
    "Fit",
    "FlexibleCoupling",
    "FluidCoupling",
    "FrequencyResponse",
    "FrequencyResponses",
    "Friction",
    "Gear",
    "Gearbox",
    "GridGenerator",
    "HystereticSpring",
    "InductionMachine",
    "Inertia",
    "Input",
    "Lock",
    "MassElastic",
    "Measurement",
    "MissingExtraError",
    "ModelError",
    "Modes",
    "OperatingPoint",
    "Parameter",
    "PendulumAbsorber",
    "Planetary",
    "Position",
    "Propeller",
    "RigidCoupling",
    "Sensor",
    "Shaft",
    "ShortCircuitScenario",
    "SolveError",
    "Spring",
    "SpringDamper",
    "SynchronousMachine",
    "TabulatedSpring",
    "TorqueConverter",
    "TorqueScenario",
    "TorsionnetError",
    "TorsionnetWarning",
    "TunedDamper",
    "Tyre",
    "Unknown",
    "UsageError",
    "Vehicle",
    "ViscousDamper",
    "bench",
    "campaign",
    "convert_damping",
    "identification",
    "identify",
    "io",
    "library_benches",
    "library_models",
    "load",
    "load_bench",
    "load_campaign",
    "load_study",
    "loads",
    "modal",
    "plot",
    "report",
    "response",
    "run_campaign",
    "sensitivity",
    "signals",
    "study",
    "symbolic",
    "units",
    "write_report",
]
