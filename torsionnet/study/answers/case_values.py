"""Values that a study has calculated in each configuration, for answers that use its variants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsionnet.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, VariantValues
from torsionnet.study.answers.answer_inputs import case_label


@dataclass(frozen=True, eq=False)
class CaseValues:
    """Parameters and quantities (n,) of the kept variants in one configuration.

    A curve has its smallest and largest value over its points, (n, 2).
    """

    configuration: str
    parameters: Mapping[str, FloatArray]
    quantities: Mapping[str, FloatArray]

    @property
    def label(self) -> str:
        """Name of the configuration in tables."""
        return case_label(self.configuration)


def case_values(study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> Iterator[CaseValues]:
    """Parameters and quantities ``names`` of the kept variants in each configuration."""
    for configuration in study.configurations:
        quantities = {name: result.kept_values(name, configuration) for name in names}
        yield CaseValues(configuration, result.kept_parameters(configuration), quantities)
