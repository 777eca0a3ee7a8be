"""Model of a drivetrain with its assembly, the coordinates, rows and coefficients that solvers use."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Self

from torsionnet.model.configurations import Overlay
from torsionnet.model.model import Model

if TYPE_CHECKING:
    from torsionnet.linear.assembly.system import Assembly


class SharedAssembly:
    """Holder of the latest assembly made by a model or by its changed copies, which share rows with it."""

    latest: Assembly | None = None


class AssembledModel(Model):
    """Model of a drivetrain whose coordinates, rows and coefficients are assembled when first used."""

    @cached_property
    def assembly(self) -> Assembly:
        """Coordinates, rows and coefficients of the drivetrain in numbers, assembled when first used."""
        from torsionnet.linear.assembly.system import assemble  # numpy, which checking a file does without

        found = assemble(self.definition, self.exact_values, like=self._shared.latest)
        self._shared.latest = found
        return found

    @cached_property
    def _shared(self) -> SharedAssembly:
        return SharedAssembly()

    def _changed(self, choice: Mapping[str, str], changes: Overlay) -> Self:
        """Changed copy of the model, whose assembly shares rows with the model's own where they are the same."""
        return self._sharing(super()._changed(choice, changes))

    def with_operating_values(self, values: Mapping[str, float], speed: float | None = None) -> Self:
        """Copy of the model at an operating point, whose assembly shares equal rows with the model's own."""
        return self._sharing(super().with_operating_values(values, speed))

    def _sharing(self, changed: Self) -> Self:
        changed._shared = self._shared
        return changed
