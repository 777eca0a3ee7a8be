# Written by `make generate`.
from torsionnet.core.notes import Note as Note
from torsionnet.response.conventions import Conventions as Conventions
from torsionnet.response.conventions import SI as SI
from torsionnet.response.critical_speeds import CriticalSpeed as CriticalSpeed
from torsionnet.response.critical_speeds import CriticalSpeeds as CriticalSpeeds
from torsionnet.response.critical_speeds import SpeedPeak as SpeedPeak
from torsionnet.response.damper_optimum import DamperOptimum as DamperOptimum
from torsionnet.response.damper_optimum import DesignParameter as DesignParameter
from torsionnet.response.dissipated_power import DissipatedPower as DissipatedPower
from torsionnet.response.estimation import Estimation as Estimation
from torsionnet.response.frequency_response import Channel as Channel
from torsionnet.response.frequency_response import FrequencyResponse as FrequencyResponse
from torsionnet.response.holzer_table import HolzerBranch as HolzerBranch
from torsionnet.response.holzer_table import HolzerLink as HolzerLink
from torsionnet.response.holzer_table import HolzerStation as HolzerStation
from torsionnet.response.holzer_table import HolzerTable as HolzerTable
from torsionnet.response.limits.limit_check import LimitCheck as LimitCheck
from torsionnet.response.limits.limit_check import LimitVerdict as LimitVerdict
from torsionnet.response.limits.limit_check import RuleText as RuleText
from torsionnet.response.limits.limit_conclusion import LimitConclusion as LimitConclusion
from torsionnet.response.limits.limit_conclusion import WorstLimit as WorstLimit
from torsionnet.response.limits.operating_instructions import instruction_table as instruction_table
from torsionnet.response.limits.speed_spans import SpeedSpan as SpeedSpan
from torsionnet.response.loop_margins import LoopMargins as LoopMargins
from torsionnet.response.loop_margins import Margin as Margin
from torsionnet.response.margin_rules import MarginClause as MarginClause
from torsionnet.response.margin_rules import MarginRule as MarginRule
from torsionnet.response.mass_elastic_table import MassElasticLine as MassElasticLine
from torsionnet.response.mass_elastic_table import MassElasticRow as MassElasticRow
from torsionnet.response.mass_elastic_table import MassElasticShaft as MassElasticShaft
from torsionnet.response.mass_elastic_table import MassElasticTable as MassElasticTable
from torsionnet.response.mass_elastic_table import StationSection as StationSection
from torsionnet.response.mean_response import MeanResponse as MeanResponse
from torsionnet.response.measured.tracked_orders import TrackedOrders as TrackedOrders
from torsionnet.response.measured.tracking_kernel import TrackingKernel as TrackingKernel
from torsionnet.response.modes import ModeRow as ModeRow
from torsionnet.response.modes import Modes as Modes
from torsionnet.response.motion.energy_balance import EnergyBalance as EnergyBalance
from torsionnet.response.motion.motion_event import MotionEvent as MotionEvent
from torsionnet.response.motion.motion_start import MotionStart as MotionStart
from torsionnet.response.order_comparison import MeasuredOrder as MeasuredOrder
from torsionnet.response.order_line import OrderLine as OrderLine
from torsionnet.response.order_response import OrderResponse as OrderResponse
from torsionnet.response.passage_response import PassagePeak as PassagePeak
from torsionnet.response.passage_response import PassageResponse as PassageResponse
from torsionnet.response.power_balance import PowerBalance as PowerBalance
from torsionnet.response.star_diagram import StarDiagram as StarDiagram
from torsionnet.response.static_state import ElementLoad as ElementLoad
from torsionnet.response.static_state import ExternalTorque as ExternalTorque
from torsionnet.response.static_state import StaticState as StaticState
from torsionnet.response.table import Column as Column
from torsionnet.response.table import Table as Table
from torsionnet.response.variant_responses import FrequencyResponses as FrequencyResponses
from torsionnet.response.vibrations.vibration_mode import VibrationMode as VibrationMode
from torsionnet.response.vibrations.vibration_mode import amplification as amplification
from torsionnet.response.worst_response import WorstResponse as WorstResponse

__all__ = [
    "Channel",
    "Column",
    "Conventions",
    "CriticalSpeed",
    "CriticalSpeeds",
    "DamperOptimum",
    "DesignParameter",
    "DissipatedPower",
    "ElementLoad",
    "EnergyBalance",
    "Estimation",
    "ExternalTorque",
    "FrequencyResponse",
    "FrequencyResponses",
    "HolzerBranch",
    "HolzerLink",
    "HolzerStation",
    "HolzerTable",
    "LimitCheck",
    "LimitConclusion",
    "LimitVerdict",
    "LoopMargins",
    "Margin",
    "MarginClause",
    "MarginRule",
    "MassElasticLine",
    "MassElasticRow",
    "MassElasticShaft",
    "MassElasticTable",
    "MeanResponse",
    "MeasuredOrder",
    "ModeRow",
    "Modes",
    "MotionEvent",
    "MotionStart",
    "Note",
    "OrderLine",
    "OrderResponse",
    "PassagePeak",
    "PassageResponse",
    "PowerBalance",
    "RuleText",
    "SI",
    "SpeedPeak",
    "SpeedSpan",
    "StarDiagram",
    "StaticState",
    "StationSection",
    "Table",
    "TrackedOrders",
    "TrackingKernel",
    "VibrationMode",
    "WorstLimit",
    "WorstResponse",
    "amplification",
    "instruction_table",
]
