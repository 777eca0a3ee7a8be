"""What a study has calculated, case by case, for answers that rest on its variants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, VariantValues
from torsionnet.study.answers.answer_inputs import case_label


@dataclass(frozen=True, eq=False)
class CaseValues:
    """Parameters and quantities (n,) of the variants in one configuration that are kept.

    A curve is there by its smallest and largest value over its points, (n, 2).
    """

    configuration: str
    parameters: Mapping[str, FloatArray]
    quantities: Mapping[str, FloatArray]

    @property
    def label(self) -> str:
        """As it is told in tables."""
        return case_label(self.configuration)


def case_values(study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> Iterator[CaseValues]:
    """The quantities ``names`` of all variants, or of very many a part; ``result.kept`` says which."""
    for configuration in study.configurations:
        quantities = {name: result.kept_values(name, configuration) for name in names}
        yield CaseValues(configuration, result.kept_parameters(configuration), quantities)
