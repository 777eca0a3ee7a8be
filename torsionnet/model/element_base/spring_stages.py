"""Entry for the stages of a spring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from torsionnet.core.entries.composite import Composite, Listed, Nested
from torsionnet.core.entries.renaming import Renaming
from torsionnet.core.entries.spec import Json, Plural, Schema, Spec
from torsionnet.core.errors import Fault, Path
from torsionnet.core.expressions import Expression
from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.quantity_group import QuantityGroup
from torsionnet.model.element_base.spring_stage import SpringStage
from torsionnet.model.element_base.stage_points import stage_faults


class SpringStages(
    Composite[tuple[SpringStage, ...]], QuantityGroup[tuple[SpringStage, ...]], Plural[tuple[SpringStage, ...]]
):
    """Entry for the stages of a spring from zero torque on.

    ``[{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]``.
    """

    is_read_off: ClassVar[bool] = True

    @property
    def absent(self) -> tuple[SpringStage, ...]:
        return ()

    @property
    def _listed(self) -> Listed[SpringStage]:
        return Listed(
            self.description,
            Nested("a stage", lambda: SpringStage, "spring_stage"),
            form="stages as [{stiffness: 6 N*m/deg, to: 120 N*m}, {stiffness: 14 N*m/deg}]",
        )

    def read(self, raw: object) -> tuple[tuple[SpringStage, ...], list[Fault]]:
        stages, faults = self._listed.read(raw)
        if faults or not stages:
            return (), faults or [Fault("expected at least one stage")]
        text = "every stage but the last needs its end; give it as to: with a torque or an angle"
        faults = [Fault(text, (place,), on_key=True) for place, stage in enumerate(stages[:-1]) if stage.end is None]
        if not faults and not any(one.names for _, _, one, _ in self.quantities(stages)):
            faults = stage_faults(stages, Values({}))
        return stages if not faults else (), faults

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return self._listed.entry_specs(raw)

    def renamed(self, value: Any, names: Renaming) -> Any:
        return self._listed.renamed(value, names)

    def quantities(self, value: Any) -> Iterator[tuple[Path, Spec[object], Expression, str]]:
        for place, stage in enumerate(value):
            for path, spec, expression, dimension in stage.quantities():
                yield (place, *path), spec, expression, dimension

    def plain(self, value: Any) -> Json:
        return self._listed.plain(value)

    def schema(self) -> Schema:
        return self._listed.schema()

    def definitions(self) -> Schema:
        return self._listed.definitions()

    @property
    def accepted(self) -> str:
        return self._listed.accepted
