"""Studies: how a drivetrain behaves over tolerances, conditions and choices of its parameters."""

from torsionnet.core.lazy import offered

__all__, __getattr__, __dir__ = offered(
    __name__,
    {
        "Correlation": "torsionnet.study.sampling.correlation",
        "ListOfValues": "torsionnet.study.variations.value_list",
        "Lognormal": "torsionnet.study.variations.lognormal",
        "Normal": "torsionnet.study.variations.normal",
        "Samples": "torsionnet.study.sampling.samples",
        "Space": "torsionnet.study.space",
        "Study": "torsionnet.study.study",
        "StudyResult": "torsionnet.study.study_result",
        "Triangular": "torsionnet.study.variations.triangle",
        "Uniform": "torsionnet.study.variations.uniform",
        "ValueRange": "torsionnet.study.variations.value_range",
        "Workers": "torsionnet.study.run.workers",
        "answer_study": "torsionnet.study.run.answering",
        "damper_over_conditions": "torsionnet.study.optimum.conditions_damper",
        "define": "torsionnet.study.study",
        "load_study": "torsionnet.study.loading_study",
        "run_study": "torsionnet.study.run.run_chunks",
    },
)
