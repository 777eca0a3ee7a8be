"""Values that a study has calculated in each of its configurations, for answers that use its variants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.answers.answer import AskedStudy, VariantValues
from torsionnet.study.answers.answer_inputs import case_label


@dataclass(frozen=True, eq=False)
class CaseValues:
    """Parameters and quantities (n,) in SI of the n kept variants of one configuration, by name.

    A curve has its smallest and largest value over its points, (n, 2).
    """

    configuration: str
    parameters: Mapping[str, FloatArray]
    quantities: Mapping[str, FloatArray]

    @property
    def label(self) -> str:
        """Name of the configuration in tables, "as given" for the model as it stands."""
        return case_label(self.configuration)


def case_values(study: AskedStudy, result: VariantValues, names: tuple[str, ...]) -> Iterator[CaseValues]:
    """Yield for each configuration the parameters and the quantities ``names`` of its kept variants."""
    for configuration in study.configurations:
        quantities = {name: result.kept_values(name, configuration) for name in names}
        yield CaseValues(configuration, result.kept_parameters(configuration), quantities)
