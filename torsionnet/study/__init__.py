"""Studies of a drivetrain over tolerances, operating conditions and choices of its parameters."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "AnsweredStudy": "torsionnet.study.run.answering",
        "Correlation": "torsionnet.study.space.correlation",
        "DamperInCondition": "torsionnet.study.design.best_damper",
        "DamperOverConditions": "torsionnet.study.design.best_damper",
        "ListOfValues": "torsionnet.study.space.variations.uniform",
        "Lognormal": "torsionnet.study.space.variations.normal",
        "Normal": "torsionnet.study.space.variations.normal",
        "Samples": "torsionnet.study.space.samples",
        "ShownUnits": "torsionnet.study.shown_units",
        "Space": "torsionnet.study.space.space",
        "Study": "torsionnet.study.study",
        "StudyResult": "torsionnet.study.study_result",
        "Summary": "torsionnet.study.reductions.summaries",
        "Triangular": "torsionnet.study.space.variations.uniform",
        "Uniform": "torsionnet.study.space.variations.uniform",
        "UserFunction": "torsionnet.study.quantities.expression",
        "ValueRange": "torsionnet.study.space.variations.uniform",
        "Workers": "torsionnet.study.run.answering",
        "answer_study": "torsionnet.study.run.answering",
        "damper_over_conditions": "torsionnet.study.design.best_damper",
        "define": "torsionnet.study.study",
        "function": "torsionnet.study.quantities.expression",
        "load_study": "torsionnet.study.study",
        "run_study": "torsionnet.study.run.run_chunks",
    },
)
