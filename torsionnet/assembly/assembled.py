"""A model with its numbers: what solvers work on."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Self

from torsionnet.model.configurations import Overlay
from torsionnet.model.model import Model

if TYPE_CHECKING:
    from torsionnet.assembly.system import Assembly


class Siblings:
    """What a model and its changed copies have in common: the assembly that one of them made last."""

    latest: Assembly | None = None


class AssembledModel(Model):
    """A model whose coordinates, rows and coefficients are there when asked for."""

    @cached_property
    def assembly(self) -> Assembly:
        """The drivetrain in numbers: coordinates, rows and coefficients."""
        from torsionnet.assembly.system import assemble  # numpy, which checking a file does without

        found = assemble(self.definition, self.exact_values, like=self._siblings.latest)
        self._siblings.latest = found
        return found

    @cached_property
    def _siblings(self) -> Siblings:
        return Siblings()

    def _changed(self, choice: Mapping[str, str], changes: Overlay) -> Self:
        """A changed copy, whose assembly may share what it has in common with those of this one and its like."""
        return self._sharing(super()._changed(choice, changes))

    def operated(self, values: Mapping[str, float]) -> Self:
        """As for any model, with what the assemblies have in common."""
        return self._sharing(super().operated(values))

    def _sharing(self, changed: Self) -> Self:
        changed.__dict__["_siblings"] = self._siblings
        return changed
