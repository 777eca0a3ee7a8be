"""Studies of a drivetrain over tolerances, operating conditions and choices of its parameters."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "DamperOverConditions": "torsionnet.study.design.best_damper",
        "Normal": "torsionnet.study.space.variations.normal",
        "Workers": "torsionnet.study.run.answering",
        "answer_study": "torsionnet.study.run.answering",
        "define": "torsionnet.study.study",
        "function": "torsionnet.study.quantities.expression",
        "load_study": "torsionnet.study.study",
        "run_study": "torsionnet.study.run.run_chunks",
    },
)
