"""What ``Drivetrain.symbolic()`` gives: the matrices, and transfer functions in the same symbols."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import sympy

from torsionnet.assembly.symbolic import OMEGA, SymbolicMatrices, symbolic_matrices
from torsionnet.channels import Sensor
from torsionnet.drivetrain import Drivetrain
from torsionnet.symbolics.program import Node
from torsionnet.symbolics.question import Asked, resolve
from torsionnet.symbolics.readings import Mechanism
from torsionnet.symbolics.transfer_function import TransferFunction

if TYPE_CHECKING:
    from torsionnet.symbolics.simplified import Simplified


@dataclass(frozen=True, eq=False)
class SymbolicSystem(SymbolicMatrices):
    """Matrices over the kept coordinates, and transfer functions.

    Attributes
    ----------
    drivetrain : Drivetrain
    referred_to : tuple of str
    mechanisms : dict
        What transfer functions before have left behind.
    """

    drivetrain: Drivetrain | None = None
    referred_to: tuple[str, ...] = ()
    mechanisms: dict[tuple[int, ...], Mechanism] = field(default_factory=dict, repr=False)

    def transfer_function(
        self, output: str | Sensor, input: str | Sensor, excitation: str | None = None
    ) -> TransferFunction:
        """One transfer function, exact and in symbols.

        Parameters
        ----------
        output, input, excitation
            As for :meth:`torsionnet.Drivetrain.frequency_response`, one of each. A measured torque that cuts the
            drivetrain in two removes everything upstream from the result.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T").static_gain
        (k_1*tau**2 + k_2)/(k_1*k_2)
        """
        drivetrain = self._model
        asked = resolve(drivetrain, output, input, excitation, self.referred_to, self.mechanisms)
        numerator, denominator = _fraction(asked)
        return TransferFunction(
            asked.channels,
            numerator,
            denominator,
            self.values,
            asked,
            _tables(drivetrain),
            drivetrain.title,
            asked.notes,
            self.conditions,
        )

    def simplified(
        self,
        output: str | Sensor,
        input: str | Sensor,
        excitation: str | None = None,
        *,
        tolerance: float = 0.01,
        band: tuple[float, float] | None = None,
    ) -> Simplified:
        """The transfer function of a drivetrain with fewer elements, and how far it is off.

        See :func:`torsionnet.symbolics.simplified.simplified`.
        """
        from torsionnet.symbolics.simplified import simplified

        return simplified(self._model, output, input, excitation, tolerance=tolerance, band=band)

    @property
    def _model(self) -> Drivetrain:
        if self.drivetrain is None:
            msg = "these matrices do not know their drivetrain"
            raise TypeError(msg)
        return self.drivetrain


def _fraction(asked: Asked) -> tuple[Node, Node]:
    """Numerator and denominator without what they have in common."""
    mechanism = asked.mechanism
    numerator = mechanism.numerator(asked.output, asked.node) * asked.sign
    if asked.measured is None:
        denominator = mechanism.determinant(mechanism.row({asked.node: 1}))
    else:
        denominator = mechanism.numerator(asked.measured, asked.node)
    return mechanism.program.reduced(numerator, denominator)


def _tables(drivetrain: Drivetrain) -> Mapping[Any, Any]:
    """The functions kappa(omega) of tabulated elements by the symbols that stand for them."""
    laws = drivetrain.assembly.kinematics.laws
    return {sympy.Function(f"kappa_{owner}")(OMEGA): law.table.kappa for owner, law in laws if law.table is not None}


def symbolic_system(drivetrain: Drivetrain, referred_to: Collection[str] = ()) -> SymbolicSystem:
    """See :meth:`torsionnet.Drivetrain.symbolic`."""
    names: Sequence[str] = [referred_to] if isinstance(referred_to, str) else list(referred_to)
    matrices = symbolic_matrices(drivetrain, names)
    content = {entry.name: getattr(matrices, entry.name) for entry in fields(SymbolicMatrices)}
    return SymbolicSystem(**content, drivetrain=drivetrain, referred_to=tuple(names))
