# Written by `make generate`.
from torsionnet import bench as bench
from torsionnet import extend as extend
from torsionnet import identification as identification
from torsionnet import io as io
from torsionnet import machinery as machinery
from torsionnet import modal as modal
from torsionnet import motion as motion
from torsionnet import plot as plot
from torsionnet import report as report
from torsionnet import signals as signals
from torsionnet import study as study
from torsionnet.base import units as units
from torsionnet.base.conventions import Conventions as Conventions
from torsionnet.base.errors import Fault as Fault
from torsionnet.base.errors import MissingExtraError as MissingExtraError
from torsionnet.base.errors import ModelError as ModelError
from torsionnet.base.errors import SolveError as SolveError
from torsionnet.base.errors import TorsionnetError as TorsionnetError
from torsionnet.base.errors import TorsionnetWarning as TorsionnetWarning
from torsionnet.base.errors import UsageError as UsageError
from torsionnet.base.table import Table as Table
from torsionnet.base.version import __version__ as __version__
from torsionnet.bench import Bench as Bench
from torsionnet.bench import load_bench as load_bench
from torsionnet.bench.campaign.campaign import load_campaign as load_campaign
from torsionnet.bench.campaign.running_campaign import run_campaign as run_campaign
from torsionnet.drivetrain import Drivetrain as Drivetrain
from torsionnet.drivetrain import load as load
from torsionnet.drivetrain import loads as loads
from torsionnet.entry_classes import ShortCircuitScenario as ShortCircuitScenario
from torsionnet.entry_classes import TorqueScenario as TorqueScenario
from torsionnet.identification import Fit as Fit
from torsionnet.identification import Measurement as Measurement
from torsionnet.identification import Unknown as Unknown
from torsionnet.identification import identify as identify
from torsionnet.linear import sensitivity as sensitivity
from torsionnet.linear.frequency_response import Channel as Channel
from torsionnet.linear.frequency_response import FrequencyResponse as FrequencyResponse
from torsionnet.linear.modes.modes import Modes as Modes
from torsionnet.linear.responses.grid import Adaptive as Adaptive
from torsionnet.model.damping import convert_damping as convert_damping
from torsionnet.model.elements import Element as Element
from torsionnet.model.elements.element_types import ArcSpring as ArcSpring
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
from torsionnet.model.elements.element_types import LumpedMatrices as LumpedMatrices
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
from torsionnet.model.files.library import library_models as library_models
from torsionnet.report import write_report as write_report
from torsionnet.study import load_study as load_study

__all__ = [
    "__version__",
    "Adaptive",
    "ArcSpring",
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
    "Friction",
    "Gear",
    "Gearbox",
    "GridGenerator",
    "HystereticSpring",
    "InductionMachine",
    "Inertia",
    "Lock",
    "LumpedMatrices",
    "MassElastic",
    "Measurement",
    "MissingExtraError",
    "ModelError",
    "Modes",
    "PendulumAbsorber",
    "Planetary",
    "Propeller",
    "RigidCoupling",
    "Shaft",
    "ShortCircuitScenario",
    "SolveError",
    "Spring",
    "SpringDamper",
    "SynchronousMachine",
    "Table",
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
    "convert_damping",
    "extend",
    "identification",
    "identify",
    "io",
    "library_models",
    "load",
    "load_bench",
    "load_campaign",
    "load_study",
    "loads",
    "machinery",
    "modal",
    "motion",
    "plot",
    "report",
    "run_campaign",
    "sensitivity",
    "signals",
    "study",
    "units",
    "write_report",
]
