# Written by `make generate`.
from torsionnet.entry_classes import Normal as Normal
from torsionnet.study.design.best_damper import DamperOverConditions as DamperOverConditions
from torsionnet.study.quantities.expression import function as function
from torsionnet.study.run.answering import Workers as Workers
from torsionnet.study.run.answering import answer_study as answer_study
from torsionnet.study.run.run_chunks import run_study as run_study
from torsionnet.study.study import define as define
from torsionnet.study.study import load_study as load_study

__all__ = [
    "DamperOverConditions",
    "Normal",
    "Workers",
    "answer_study",
    "define",
    "function",
    "load_study",
    "run_study",
]
