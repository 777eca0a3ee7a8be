# Written by `make generate`.
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed as CriticalSpeed
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds as CriticalSpeeds
from torsionnet.machinery.criticals.critical_speeds import SpeedPeak as SpeedPeak
from torsionnet.machinery.design.damper_optimum import DamperOptimum as DamperOptimum
from torsionnet.machinery.design.damper_optimum import DesignParameter as DesignParameter
from torsionnet.machinery.holzer.holzer_table import HolzerBranch as HolzerBranch
from torsionnet.machinery.holzer.holzer_table import HolzerLink as HolzerLink
from torsionnet.machinery.holzer.holzer_table import HolzerStation as HolzerStation
from torsionnet.machinery.holzer.holzer_table import HolzerTable as HolzerTable
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticLine as MassElasticLine
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticRow as MassElasticRow
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticShaft as MassElasticShaft
from torsionnet.machinery.holzer.mass_elastic_table import MassElasticTable as MassElasticTable
from torsionnet.machinery.holzer.mass_elastic_table import StationSection as StationSection
from torsionnet.machinery.mean.dissipation import DissipatedPower as DissipatedPower
from torsionnet.machinery.mean.mean_solution import MeanResponse as MeanResponse
from torsionnet.machinery.mean.static_state import ElementLoad as ElementLoad
from torsionnet.machinery.mean.static_state import ExternalTorque as ExternalTorque
from torsionnet.machinery.mean.static_state import PowerBalance as PowerBalance
from torsionnet.machinery.mean.static_state import StaticState as StaticState
from torsionnet.machinery.orders.order_line import OrderLine as OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse as OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse as WorstResponse
from torsionnet.machinery.passage.passage_response import PassagePeak as PassagePeak
from torsionnet.machinery.passage.passage_response import PassageResponse as PassageResponse
from torsionnet.machinery.phasors.vector_sums import StarDiagram as StarDiagram
from torsionnet.machinery.verdicts.limit_check import LimitCheck as LimitCheck
from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion as LimitConclusion
from torsionnet.machinery.verdicts.limit_conclusion import WorstLimit as WorstLimit
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict as LimitVerdict
from torsionnet.machinery.verdicts.margin_rules import MarginClause as MarginClause
from torsionnet.machinery.verdicts.margin_rules import MarginRule as MarginRule
from torsionnet.machinery.verdicts.operating_instructions import instruction_table as instruction_table
from torsionnet.machinery.verdicts.rule_factors import RuleText as RuleText
from torsionnet.machinery.verdicts.speed_spans import SpeedSpan as SpeedSpan

__all__ = [
    "CriticalSpeed",
    "CriticalSpeeds",
    "DamperOptimum",
    "DesignParameter",
    "DissipatedPower",
    "ElementLoad",
    "ExternalTorque",
    "HolzerBranch",
    "HolzerLink",
    "HolzerStation",
    "HolzerTable",
    "LimitCheck",
    "LimitConclusion",
    "LimitVerdict",
    "MarginClause",
    "MarginRule",
    "MassElasticLine",
    "MassElasticRow",
    "MassElasticShaft",
    "MassElasticTable",
    "MeanResponse",
    "OrderLine",
    "OrderResponse",
    "PassagePeak",
    "PassageResponse",
    "PowerBalance",
    "RuleText",
    "SpeedPeak",
    "SpeedSpan",
    "StarDiagram",
    "StaticState",
    "StationSection",
    "WorstLimit",
    "WorstResponse",
    "instruction_table",
]
