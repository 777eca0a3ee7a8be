"""What a study has calculated, case by case, for answers that rest on its variants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answer import AskedStudy, VariantValues
from torsionnet.study.answers.asking import case_label


@dataclass(frozen=True, eq=False)
class CaseValues:
    """Parameters and quantities (n,) of all variants in one configuration."""

    configuration: str
    parameters: Mapping[str, FloatArray]
    quantities: Mapping[str, FloatArray]

    @property
    def label(self) -> str:
        """As it is told in tables."""
        return case_label(self.configuration)


def case_values(study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> Iterator[CaseValues]:
    """The quantities ``names`` of all variants."""
    for configuration in study.configurations:
        quantities = {name: result.values(name, configuration) for name in names}
        yield CaseValues(configuration, result.parameters(configuration), quantities)
