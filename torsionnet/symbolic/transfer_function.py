"""Symbolic transfer function and its forms (mechanical, polynomial, normalised, program, expanded)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import sympy
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.program import Program
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.symbolic.formula_text import for_display, latex, with_where
from torsionnet.symbolic.symbolic_request import SymbolicFraction

if TYPE_CHECKING:
    from torsionnet.symbolic.formula_text import WhereTable
    from torsionnet.symbolic.normalised import Expanded, Normalised
    from torsionnet.symbolic.rational import Rational

MOST_PRINTED = 60
"""Largest number of operations of a transfer function that is printed in one line, as longer ones are hard to read."""
MOST_LEAVES = 5000
"""Largest number of leaves (stiffnesses, ratios, numbers) of a nested transfer function that is written out, as more
fill pages."""

FORMS = ("mechanical", "polynomial", "normalised", "program", "expanded")
"""Names of the forms in which a transfer function can be written as text or LaTeX."""


@dataclass(frozen=True, eq=False)
class TransferFunction(SymbolicFraction):
    """Symbolic transfer function of one output over one input, exact, in the model's own symbols.

    Everything follows from one straight-line program for numerator and denominator, which has no subtraction and no
    division; the forms are worked out when first used.

    Examples
    --------
    >>> import torsionnet as tn
    >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
    >>> H.mechanical
    1/(I_2*s**2 + k_2 + s*(c_2 + c_B)) + 1/(c_1*s + k_1)
    >>> H.static_gain
    (k_1 + k_2)/(k_1*k_2)
    """

    @cached_property
    def polynomial(self) -> Rational:
        """Transfer function as a quotient of polynomials in s, with named coefficients a_i, b_i.

        Raises
        ------
        UsageError
            It would fill pages.
        """
        from torsionnet.symbolic.algebra.delay import refuse_delays
        from torsionnet.symbolic.rational import rational, require_readable

        refuse_delays(self.used_tables, "form of two polynomials")
        require_readable(self)
        return rational(self)

    @cached_property
    def normalised(self) -> Normalised:
        """Transfer function as static gain and factors with omega_n (rad/s) and zeta of first and second order.

        Raises
        ------
        UsageError
            It would fill pages.
        """
        from torsionnet.symbolic.algebra.delay import refuse_delays
        from torsionnet.symbolic.normalised import normalised
        from torsionnet.symbolic.rational import require_readable

        refuse_delays(self.used_tables, "normalised form")
        require_readable(self)
        return normalised(self)

    @cached_property
    def program(self) -> WhereTable:
        """Straight-line program of the transfer function, with a name for every repeated result."""
        from torsionnet.symbolic.formula_text import where_table

        return where_table(self)

    def predicted_terms(self) -> int:
        """Upper bound of the number of terms of numerator and denominator when fully expanded."""
        from torsionnet.symbolic.normalised import predicted_terms

        return predicted_terms(self)

    def expanded(self, cap: int = 50_000) -> Expanded:
        """Numerator and denominator of the transfer function multiplied out to sums of terms in s and parameters.

        Raises
        ------
        UsageError
            More than ``cap`` terms are predicted; the message has the number.
        """
        from torsionnet.symbolic.normalised import expanded

        return expanded(self, cap)

    @property
    def static_gain(self) -> Any:
        """Static gain of the transfer function (limit at zero frequency), an expression, 0 or sympy's infinity."""
        from torsionnet.symbolic.rational import static_gain

        return static_gain(self)

    @property
    def low_frequency(self) -> Any:
        """Leading term of the transfer function for s -> 0, gain * s^power, a sympy expression."""
        from torsionnet.symbolic.rational import low_frequency

        return low_frequency(self)

    @property
    def high_frequency(self) -> Any:
        """Leading term of the transfer function for s -> oo, gain * s^power, a sympy expression."""
        from torsionnet.symbolic.rational import high_frequency

        return high_frequency(self)

    def derivative(self, parameter: str) -> TransferFunction:
        """Derivative of the transfer function with respect to a parameter, with all forms but the mechanical one.

        Examples
        --------
        >>> import torsionnet as tn
        >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        >>> H.derivative("k_2").static_gain
        -1/k_2**2
        """
        from torsionnet.symbolic.algebra.changed import Derivatives

        program, symbol = Program(), self._symbol(parameter)
        for function, table in self.used_tables.items():
            if any(coefficient.has(symbol) for coefficient in table.coefficients):
                raise UsageError(
                    f"the derivative of {function} to {symbol} has no symbols; use "
                    "torsionnet.linear.sensitivity, which has it in numbers",
                    kind="unsupported-law",
                )
        algebra = Derivatives(program, symbol)
        (above, slope_above), (below, slope_below) = self.steps.values_in(algebra, self.outputs)
        # (N / D)' = (N' D - N D') / D^2
        numerator = slope_above * below + slope_below * above * -1
        numerator, denominator = program.reduced(numerator, below * below)
        return replace(self, outputs=(numerator, denominator), request=None)

    def subs(self, values: Mapping[str, Any] | None = None, /, **more: Any) -> TransferFunction:
        """Transfer function with exact numbers (0.5 becomes 1/2) or sympy expressions for parameters."""
        given = {self._symbol(name): _exact(value) for name, value in {**(values or {}), **more}.items()}
        return self._changed(given) if given else self

    def keep(self, names: Collection[str]) -> TransferFunction:
        """Transfer function in which only the named parameters stay symbols, others having their exact values.

        Examples
        --------
        >>> import torsionnet as tn
        >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        >>> H.keep(["k_2"]).mechanical
        1/(k_2 + 19*s**2/125 + 43*s/10) + 1/(s/10 + 13300)
        """
        kept = {self._symbol(name) for name in names}
        return self._changed({name: self.values[name] for name in self.free_symbols - kept if name in self.values})

    def _changed(self, given: dict[Any, Any]) -> TransferFunction:
        from torsionnet.symbolic.algebra.changed import SubstitutedLeaves

        def change(expression: Any) -> Any:
            return given.get(expression, expression) if expression.is_Atom else expression.xreplace(given)

        program = Program()
        nodes = self.steps.values_in(SubstitutedLeaves(program, change), self.outputs)
        numerator, denominator = program.reduced(*nodes)
        request = None if self.request is None else self.request.changed(change)
        tables = {
            name: table.with_coefficients(*map(change, table.coefficients)) for name, table in self.tables.items()
        }
        return replace(self, outputs=(numerator, denominator), request=request, tables=tables)

    def _symbol(self, name: str) -> Any:
        known = {str(symbol): symbol for symbol in {*self.values, *self.free_symbols}}
        if str(name) not in known:
            raise UsageError(
                f'no parameter is named "{name}"{did_you_mean(str(name), known)}', kind="unknown-parameter"
            )
        return known[str(name)]

    def evaluate(self, frequencies: ArrayLike, **parameters: float) -> FrequencyResponse:
        """Frequency response, values (n_f, 1, 1) in SI, at frequencies in Hz, by default with the model's parameters.

        Examples
        --------
        >>> import torsionnet as tn
        >>> H = tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T")
        >>> round(float(abs(H.evaluate([8.116]).values.item())) * 57.29578, 4)
        0.2519
        """
        from torsionnet.symbolic.rational import evaluate

        return evaluate(self, frequencies, {self._symbol(name): value for name, value in parameters.items()})

    def python_code(self, name: str = "transfer_function") -> str:
        """Python source text of a numpy function of frequency in Hz and the parameters in SI."""
        from torsionnet.symbolic.code import python_code

        return python_code(self, name)

    def to_text(self, form: str = "mechanical") -> str:
        """Text of one form of the transfer function, or with ``"python"`` source text of a numpy function.

        Raises
        ------
        UsageError
            No such form, or one that would fill pages.

        Examples
        --------
        >>> import torsionnet as tn
        >>> print(tn.load("dmf_rig").symbolic().transfer_function("theta_1", "T_T").to_text("program"))
        (z_1 + z_2)/(z_1*z_2)
          z_1 = c_1*s + k_1
          z_2 = k_2 + s*(I_2*s + c_2 + c_B)
        """
        from torsionnet.symbolic.rational import require_short

        if form == "mechanical":
            require_short(self, MOST_LEAVES)
            return str(for_display(self.mechanical))
        if form in FORMS:
            return str(self.expanded().expression if form == "expanded" else getattr(self, form))
        if form == "python":
            return self.python_code()
        known = (*FORMS, "python")
        raise UsageError(
            f'unknown form "{form}"{did_you_mean(form, known)}; choose {", ".join(known)}', kind="unknown-word"
        )

    def to_latex(self, form: str = "mechanical") -> str:
        """LaTeX of one form of the transfer function (mechanical, polynomial, normalised, program, expanded).

        Raises
        ------
        UsageError
            No such form, or one that would fill pages.
        """
        from torsionnet.symbolic.rational import require_short

        if form == "mechanical":
            require_short(self, MOST_LEAVES)
            return latex(self.mechanical)
        if form in ("polynomial", "normalised"):
            return (self.polynomial if form == "polynomial" else self.normalised).to_latex()
        if form == "program":
            table, result = self.program.where()
            return with_where(latex(result), table)
        if form == "expanded":
            return latex(self.expanded().expression)
        raise UsageError(
            f'unknown form "{form}"{did_you_mean(form, FORMS)}; choose {", ".join(FORMS)}', kind="unknown-word"
        )

    def _repr_latex_(self) -> str | None:
        form = self._short_form
        return f"$\\displaystyle {self.to_latex(form)}$" if form else None

    @property
    def _short_form(self) -> str:
        """Name of the form of the transfer function shown by default, empty if all are too long."""
        operations = self.program.operations
        if operations <= MOST_PRINTED and self.nested_leaves <= MOST_LEAVES:
            return "mechanical"
        return "program" if operations <= 10 * MOST_PRINTED else ""

    def __repr__(self) -> str:
        names = " / ".join(channel.name for channel in self.channels)
        operations = self.program.operations
        return f"<TransferFunction {names}: {len(self.free_symbols)} parameters, {operations} operations>"

    def __str__(self) -> str:
        """Text of the transfer function, its mechanical form if short, else its straight-line program."""
        names = "/".join(channel.name for channel in self.channels)
        if self._short_form == "mechanical":
            return f"{names} = {for_display(self.mechanical)}"
        if self._short_form == "program":
            return f"{names} = {self.program}"
        return f"{names}: {self.program.operations} operations; print its .program, or ask for .python_code()"


def _exact(value: Any) -> Any:
    from torsionnet.linear.assembly.symbolic import rational

    return value if isinstance(value, sympy.Basic) else rational(value)
