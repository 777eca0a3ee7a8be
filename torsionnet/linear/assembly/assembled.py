"""Model of a drivetrain with its assembly, the coordinates, rows and coefficients that solvers use."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from torsionnet.model.model import Model

if TYPE_CHECKING:
    from torsionnet.linear.assembly.rows import Assembly


class AssembledModel(Model):
    """Model of a drivetrain whose coordinates, rows and coefficients are assembled when first used."""

    @cached_property
    def assembly(self) -> Assembly:
        """Coordinates, rows and coefficients of the drivetrain in numbers, assembled when first used."""
        from torsionnet.linear.assembly.rows import assemble  # numpy, which checking a file does without

        assembly = assemble(self.definition, self.exact_values, like=self._state.shared.assembly)
        # Changed copies have it, too: their assemblies take over the rows that are the same.
        self._state.shared.assembly = assembly
        return assembly
