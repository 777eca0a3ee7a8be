"""Symbolic system of ``Drivetrain.symbolic()``, with matrices and transfer functions in the same symbols."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import comma_list
from torsionnet.base.program import ProgramNode
from torsionnet.base.registers import Memo
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.symbolic import (
    SymbolicMatrices,
    stiffness_symbol,
    symbol_of,
    symbolic_matrices,
    symbolic_values,
    with_symbols,
)
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_request
from torsionnet.linear.frequency_response import Channel
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import Action, Law
from torsionnet.model.kinematics import owned_parts
from torsionnet.symbolic.symbolic_request import (
    SymbolicRequest,
    hold_imposed_angles,
    is_imposed,
    require_one_channel_each,
    resolve,
    without_imposed_angles,
)
from torsionnet.symbolic.transfer_function import TransferFunction

if TYPE_CHECKING:
    from torsionnet.symbolic.simplified import Simplified
    from torsionnet.symbolic.transfer_matrix import TransferMatrix


MOST_SHOWN = 8
"""Largest number of coordinates of a system that a notebook shows as matrices, as larger ones do not fit a page."""


@dataclass(frozen=True, eq=False, repr=False)
class SymbolicSystem(SymbolicMatrices):
    """Symbolic matrices of the equations of motion of a drivetrain, and transfer functions in the same symbols.

    Attributes
    ----------
    drivetrain : Drivetrain
    referred_to : tuple of str
    memo : Memo
        What transfer functions before have left behind.
    """

    drivetrain: AssembledModel | None = None
    referred_to: tuple[str, ...] = ()
    memo: Memo = field(default_factory=Memo, repr=False)

    def transfer_function(
        self, output: str | Sensor, input: str | Sensor | Input, driven_by: str | Input | None = None
    ) -> TransferFunction:
        """Exact symbolic transfer function from one input of the drivetrain to one output.

        Parameters
        ----------
        output, input, driven_by
            As for :meth:`torsionnet.Drivetrain.frequency_response`, one of each. A measured torque that cuts the
            drivetrain in two removes everything upstream from the result; an imposed angle removes what hangs on the
            driven node alone.

        Examples
        --------
        >>> import torsionnet as tn
        >>> tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T").static_gain
        (k_1*tau**2 + k_2)/(k_1*k_2)
        """
        drivetrain = self._model
        require_one_channel_each(output, input)
        request = without_imposed_angles(drivetrain, output, input, driven_by)
        memo = self.memo if request.drivetrain is drivetrain else None
        asked = resolve(request.drivetrain, output, request.input, request.excitation, self.referred_to, memo)
        if request.channel is not None:
            asked = replace(asked, channels=(asked.channels[0], request.channel))
        return replace(self._written(asked.channels, *_fraction(asked), asked.notes), request=asked)

    def transfer_matrix(
        self,
        output: Sequence[str | Sensor],
        input: Sequence[str | Sensor | Input],
        driven_by: str | Input | Sequence[str | Input] | None = None,
    ) -> TransferMatrix:
        """Matrix of symbolic transfer functions, a row for each output and a column for each input.

        Parameters
        ----------
        outputs, inputs, excitation
            As for :meth:`torsionnet.Drivetrain.frequency_response`. At most three inputs are measured at a time.

        Examples
        --------
        >>> import torsionnet as tn
        >>> print(tn.load("dmf_rig").symbolic().transfer_matrix(["theta_1", "T_T"], ["T_M"])["T_T", "T_M"].static_gain)
        1
        """
        from torsionnet.symbolic.transfer_matrix import TransferMatrix, measured_transfer_matrix

        drivetrain = self._model
        request = resolve_request(drivetrain, list(output), list(input), driven_by)
        if request.is_measured and len(input) > 1:
            return measured_transfer_matrix(drivetrain, request, self._written)
        given = driven_by if isinstance(driven_by, str | Input | None) else driven_by[0]
        source = given if request.is_measured else None
        return TransferMatrix(
            tuple(tuple(self.transfer_function(row, column, source) for column in input) for row in output)
        )

    def _written(
        self,
        channels: tuple[Channel, Channel],
        numerator: ProgramNode,
        denominator: ProgramNode,
        notes: tuple[str, ...],
    ) -> TransferFunction:
        drivetrain = self._model
        return TransferFunction(
            channels,
            (numerator, denominator),
            self.values,
            tables=_tables(drivetrain),
            title=drivetrain.title,
            notes=notes,
            conditions=self.conditions,
            model=drivetrain.name,
            configuration=drivetrain.configuration,
        )

    def simplified(
        self,
        output: str | Sensor,
        input: str | Sensor,
        driven_by: str | None = None,
        *,
        tolerance: float = 0.01,
        band: tuple[float, float] | None = None,
    ) -> Simplified:
        """Transfer function of the drivetrain with fewer elements, and the error that leaving out the others makes.

        See :func:`torsionnet.symbolic.simplified.simplified`.
        """
        from torsionnet.symbolic.simplified import simplified

        def written(rig: AssembledModel) -> TransferFunction:
            return symbolic(rig).transfer_function(output, input, driven_by)

        return simplified(self._model, output, input, driven_by, written=written, tolerance=tolerance, band=band)

    @property
    def formulas(self) -> Mapping[Any, Any]:
        """Formula of each continuous shaft's kappa(omega) in omega and parameters, a sympy expression in N m/rad."""
        formulas = {name: table.formula(name.args[0]) for name, table in _tables(self._model).items()}
        return {name: formula for name, formula in formulas.items() if formula is not None}

    def to_latex(self, part: str = "") -> str:
        r"""LaTeX of the equations of motion as a matrix equation, or of one part (M, C, K, H, q, B or u).

        Examples
        --------
        >>> import torsionnet as tn
        >>> print(tn.load("amt_rig").symbolic().to_latex("K"))
        \begin{bmatrix} k_{1} & - k_{1} \\ - k_{1} & k_{1} + \frac{k_{2}}{\tau^{2}} \end{bmatrix}
        """
        from torsionnet.symbolic.equations import to_latex

        return to_latex(self, part)

    def __repr__(self) -> str:
        shown = comma_list(self.coordinates, MOST_SHOWN, ", ...")
        return f"<SymbolicSystem: M, C, K over {len(self.coordinates)} coordinates, {shown}>"

    def _repr_latex_(self) -> str | None:
        return f"$\\displaystyle {self.to_latex()}$" if len(self.coordinates) <= MOST_SHOWN else None

    @property
    def _model(self) -> AssembledModel:
        if self.drivetrain is None:
            raise TypeError("this SymbolicSystem has no drivetrain; make it with Drivetrain.symbolic()")
        return self.drivetrain


def _fraction(asked: SymbolicRequest) -> tuple[ProgramNode, ProgramNode]:
    """Numerator and denominator of a requested transfer function, without common factors, as program nodes."""
    mechanism = asked.mechanism
    numerator = mechanism.numerator(asked.output, asked.load) * asked.sign
    if asked.measured is None:
        denominator = mechanism.determinant(mechanism.row(asked.load))
    else:
        denominator = mechanism.numerator(asked.measured, asked.load)
    return mechanism.program.reduced(numerator, denominator)


def _tables(drivetrain: AssembledModel) -> Mapping[Any, Any]:
    """Frequency-dependent stiffnesses and delays by their symbols, with sympy expressions as coefficients."""
    values = symbolic_values(drivetrain.definition.parameters, drivetrain.exact_values)
    parts = [(owned.element, owned.part) for owned in owned_parts(drivetrain.definition, values)]
    laws = [(owner, part) for owner, part in parts if isinstance(part, Law)]
    tables = {
        stiffness_symbol(owner, law.table): with_symbols(law.table) for owner, law in laws if law.table is not None
    }
    delays = [(owner, symbol_of(part.delay)) for owner, part in parts if isinstance(part, Action)]
    if not delays:
        return tables
    from torsionnet.symbolic.algebra.delay import Delay, delay_symbol

    return tables | {delay_symbol(owner): Delay(time) for owner, time in delays if time != 0}


def symbolic(drivetrain: AssembledModel, *, referred_to: Sequence[str] = ()) -> SymbolicSystem:
    """Symbolic model, which has M, C, K and transfer functions in the model's own symbols.

    ``referred_to`` chooses the nodes kept as coordinates; they stand in the order given.

    Examples
    --------
    >>> import torsionnet as tn
    >>> tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").mechanical
    1/(I_2*s**2 + k_2 + s*(c_2 + c_B)) + 1/(c_1*s + k_1)
    """
    names: Sequence[str] = [referred_to] if isinstance(referred_to, str) else list(referred_to)
    matrices = symbolic_matrices(hold_imposed_angles(drivetrain) if is_imposed(drivetrain) else drivetrain, names)
    content = {entry.name: getattr(matrices, entry.name) for entry in fields(SymbolicMatrices)}
    return SymbolicSystem(**content, drivetrain=drivetrain, referred_to=tuple(names))
