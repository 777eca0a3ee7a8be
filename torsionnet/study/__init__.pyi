# Written by `make generate`.
from torsionnet.entry_classes import Correlation as Correlation
from torsionnet.entry_classes import ListOfValues as ListOfValues
from torsionnet.entry_classes import Lognormal as Lognormal
from torsionnet.entry_classes import Normal as Normal
from torsionnet.entry_classes import Samples as Samples
from torsionnet.entry_classes import Triangular as Triangular
from torsionnet.entry_classes import Uniform as Uniform
from torsionnet.entry_classes import ValueRange as ValueRange
from torsionnet.study.design.best_damper import DamperInCondition as DamperInCondition
from torsionnet.study.design.best_damper import DamperOverConditions as DamperOverConditions
from torsionnet.study.design.best_damper import damper_over_conditions as damper_over_conditions
from torsionnet.study.quantities.expression import UserFunction as UserFunction
from torsionnet.study.quantities.expression import function as function
from torsionnet.study.reductions.summaries import Summary as Summary
from torsionnet.study.run.answering import AnsweredStudy as AnsweredStudy
from torsionnet.study.run.answering import Workers as Workers
from torsionnet.study.run.answering import answer_study as answer_study
from torsionnet.study.run.run_chunks import run_study as run_study
from torsionnet.study.shown_units import ShownUnits as ShownUnits
from torsionnet.study.space.space import Space as Space
from torsionnet.study.study import Study as Study
from torsionnet.study.study import define as define
from torsionnet.study.study import load_study as load_study
from torsionnet.study.study_result import StudyResult as StudyResult

__all__ = [
    "AnsweredStudy",
    "Correlation",
    "DamperInCondition",
    "DamperOverConditions",
    "ListOfValues",
    "Lognormal",
    "Normal",
    "Samples",
    "ShownUnits",
    "Space",
    "Study",
    "StudyResult",
    "Summary",
    "Triangular",
    "Uniform",
    "UserFunction",
    "ValueRange",
    "Workers",
    "answer_study",
    "damper_over_conditions",
    "define",
    "function",
    "load_study",
    "run_study",
]
