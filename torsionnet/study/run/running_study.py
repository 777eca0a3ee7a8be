"""A study as its answers see it while it runs."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from torsionnet.study.quantities.evaluator import BlockDesk, Evaluator
from torsionnet.study.study import Study


@dataclass(frozen=True, eq=False)
class RunningStudy(Study):
    """A study whose evaluators leave their work to a desk."""

    desk: BlockDesk | None = None

    def evaluator(self, configuration: str = "", names: tuple[str, ...] = (), method: str = "") -> Evaluator:
        """As that of the study, calculated by the desk."""
        return replace(super().evaluator(configuration, names, method), desk=self.desk)


def running(study: Study, desk: BlockDesk) -> RunningStudy:
    """The same study, with a desk."""
    return RunningStudy(**{one.name: getattr(study, one.name) for one in fields(study)}, desk=desk)
