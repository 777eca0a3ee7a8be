"""Studies: how a drivetrain behaves over tolerances, conditions and choices of its parameters."""

from typing import TYPE_CHECKING

from torsionnet.core.lazy import names_on_demand

if TYPE_CHECKING:
    from torsionnet.study.design.conditions_damper import damper_over_conditions as damper_over_conditions
    from torsionnet.study.loading_study import load_study as load_study
    from torsionnet.study.run.answering import answer_study as answer_study
    from torsionnet.study.run.run_chunks import run_study as run_study
    from torsionnet.study.run.workers import Workers as Workers
    from torsionnet.study.space.correlation import Correlation as Correlation
    from torsionnet.study.space.samples import Samples as Samples
    from torsionnet.study.space.space import Space as Space
    from torsionnet.study.space.variations.lognormal import Lognormal as Lognormal
    from torsionnet.study.space.variations.normal import Normal as Normal
    from torsionnet.study.space.variations.triangle import Triangular as Triangular
    from torsionnet.study.space.variations.uniform import Uniform as Uniform
    from torsionnet.study.space.variations.value_list import ListOfValues as ListOfValues
    from torsionnet.study.space.variations.value_range import ValueRange as ValueRange
    from torsionnet.study.study import Study as Study
    from torsionnet.study.study import define as define
    from torsionnet.study.study_result import StudyResult as StudyResult

_HOMES = {
    "Correlation": "torsionnet.study.space.correlation",
    "ListOfValues": "torsionnet.study.space.variations.value_list",
    "Lognormal": "torsionnet.study.space.variations.lognormal",
    "Normal": "torsionnet.study.space.variations.normal",
    "Samples": "torsionnet.study.space.samples",
    "Space": "torsionnet.study.space.space",
    "Study": "torsionnet.study.study",
    "StudyResult": "torsionnet.study.study_result",
    "Triangular": "torsionnet.study.space.variations.triangle",
    "Uniform": "torsionnet.study.space.variations.uniform",
    "ValueRange": "torsionnet.study.space.variations.value_range",
    "Workers": "torsionnet.study.run.workers",
    "answer_study": "torsionnet.study.run.answering",
    "damper_over_conditions": "torsionnet.study.design.conditions_damper",
    "define": "torsionnet.study.study",
    "load_study": "torsionnet.study.loading_study",
    "run_study": "torsionnet.study.run.run_chunks",
}

__all__ = list(_HOMES)
__getattr__ = names_on_demand(__name__, _HOMES)
