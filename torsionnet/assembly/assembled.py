"""A model with its numbers: what solvers work on."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Self

from torsionnet.model.configurations import Overlay
from torsionnet.model.model import Model

if TYPE_CHECKING:
    from torsionnet.assembly.system import Assembly


class AssembledModel(Model):
    """A model whose coordinates, rows and coefficients are there when asked for."""

    _like: Assembly | None = None

    @cached_property
    def assembly(self) -> Assembly:
        """The drivetrain in numbers: coordinates, rows and coefficients."""
        from torsionnet.assembly.system import assemble  # numpy, which checking a file does without

        return assemble(self.definition, self.exact_values, like=self._like)

    def _changed(self, choice: Mapping[str, str], changes: Overlay) -> Self:
        """A changed copy, whose assembly may share what it has in common with this one."""
        return self._sharing(super()._changed(choice, changes))

    def operated(self, values: Mapping[str, float]) -> Self:
        """As for any model, with what both assemblies have in common."""
        return self._sharing(super().operated(values))

    def _sharing(self, changed: Self) -> Self:
        changed._like = self.__dict__.get("assembly", self._like)
        return changed
