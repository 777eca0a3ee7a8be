"""What every stiffness that depends on frequency goes through: a measured one times a parameter, against plain sums."""

import pickle
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Expression
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.linear.sensitivity.sensitivities_of_modes import mode_sensitivities
from torsionnet.model.element_base.dynamic_stiffness import ScaledStiffness
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.laws import difference
from torsionnet.model.element_base.stiffness_table import StiffnessTable, TableEntry
from torsionnet.model.elements import Law

F = np.array([0.5, 1.7, 3.0, 12.0])
ROWS = [[1, 300, 2], [9, 700, 1]]


@dataclass(frozen=True, eq=False, repr=False)
class Bushes(Element):
    """As many measured bushes as ``number`` says, and half as many again in parallel."""

    kind: ClassVar[str] = "bushes"
    glyph: ClassVar[str] = "spring"
    nodes: tuple[str, str] = entry(NodePair("both ends"))
    table: StiffnessTable = entry(TableEntry("rows"))  # noqa: RUF009
    number: Expression = entry(PhysicalQuantity("how many", "1", "n"))  # noqa: RUF009

    def own_parts(self, value):
        row, n = difference(*self.nodes), value(self.number)
        return (
            Law(row, table=ScaledStiffness(self.table, n, "all")),
            Law(row, table=ScaledStiffness(self.table, n / 2, "half")),
        )


def rig(n=2.0):
    return tn.Drivetrain(
        "t",
        [
            tn.Inertia("j", node="a", inertia=1),
            tn.Damper("c", nodes=("a", "ground"), damping=0.1),
            Bushes("bush", nodes=("a", "ground"), table=ROWS, number="2*n"),
        ],
        {"n": n},
    )


def expected(n, f, damping=0.1):
    k, c = np.interp(f, (1, 9), (300, 700)), np.interp(f, (1, 9), (2, 1))
    w = 2 * np.pi * f
    return 1 / (3 * n * (k + 1j * w * c) + damping * 1j * w - w**2)


def test_response_of_a_table_times_a_parameter():
    found = rig().frequency_response("a", "a", F).values[:, 0, 0]
    np.testing.assert_allclose(found, expected(2.0, F), rtol=1e-13)


def test_derivative_of_a_response_to_its_parameter():
    found = parametric_response(rig(), "a", "a", F, ["n"]).evaluation([2.0])
    change = (expected(2 + 1e-5, F) - expected(2 - 1e-5, F)) / 2e-5
    np.testing.assert_allclose(found.jacobian[:, 0, 0, 0], change, rtol=1e-8)


def test_derivative_of_a_pole_to_its_parameter():
    def pole(n):
        return rig(n).modes().eigenvalues[0]

    (slope,) = mode_sensitivities(rig(), ["n"]).pole_slopes[0]
    assert slope == pytest.approx((pole(2 + 1e-5) - pole(2 - 1e-5)) / 2e-5, rel=1e-7)


def test_symbols_tell_the_laws_of_an_element_apart_and_take_other_values():
    H = rig().symbolic().transfer_function("a", "a")
    assert {str(name) for name in H.used_tables} == {"kappa_bush_all(omega)", "kappa_bush_half(omega)"}
    for n in (2.0, 5.0):
        np.testing.assert_allclose(H.evaluate(F, n=n).values[:, 0, 0], expected(n, F), rtol=1e-12)
        np.testing.assert_allclose(H.subs(n=n).evaluate(F).values[:, 0, 0], expected(n, F), rtol=1e-12)
    assert H.evaluate([0.0]).values.item() == pytest.approx(1 / 1800)


def test_a_derivative_in_symbols_is_refused():
    with pytest.raises(UsageError, match="kappa_bush_all"):
        rig().symbolic().transfer_function("a", "a").derivative("n")


def test_assemblies_can_be_pickled():
    system = pickle.loads(pickle.dumps(rig().assembly.system))
    assert system.dynamic[0][1] == rig().assembly.system.dynamic[0][1]
