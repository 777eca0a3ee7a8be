"""Equations of motion in symbols: the paper's matrices, reflected terms, agreement with the numbers."""

import numpy as np
import pytest
import sympy
from support.models import EVERY_ELEMENT, geared_line
from sympy import Matrix, Rational, Symbol

import torsionnet as tn

I_1, I_2, k_1, k_2, c_1, c_2, c_B, c_M, c_O, tau = sympy.symbols("I_1 I_2 k_1 k_2 c_1 c_2 c_B c_M c_O tau")


def test_equation_7_of_the_paper():
    S = tn.load("dmf_rig").symbolic()
    assert S.M == Matrix([[I_1, 0], [0, I_2]])
    assert S.C == Matrix([[c_1 + c_M, -c_1], [-c_1, c_1 + c_2 + c_B]])
    assert S.K == Matrix([[k_1, -k_1], [-k_1, k_1 + k_2]])
    assert S.B == Matrix([1, 0])


def test_equation_19_of_the_paper():
    S = tn.load("amt_rig").symbolic()
    assert S.M == Matrix([[I_1, 0], [0, I_2]])
    assert S.C == Matrix([[c_1 + c_M, -c_1], [-c_1, c_1 + c_B + c_O / tau**2]])
    assert S.K == Matrix([[k_1, -k_1], [-k_1, k_1 + k_2 / tau**2]])
    assert S.coordinates == ("motor", "input_shaft")


def test_referred_to_the_other_side_of_the_gear():
    S = tn.load("amt_rig").symbolic(referred_to=["output_shaft"])
    assert S.coordinates == ("motor", "output_shaft")
    assert S.K == Matrix([[k_1, -k_1 * tau], [-k_1 * tau, k_1 * tau**2 + k_2]])


def test_coordinates_stand_in_the_order_given():
    S = tn.load("amt_rig").symbolic(referred_to=["output_shaft", "motor"])
    assert S.coordinates == ("output_shaft", "motor")
    assert S.K == Matrix([[k_1 * tau**2 + k_2, -k_1 * tau], [-k_1 * tau, k_1]])
    assert S.T[S.nodes.index("motor"), :] == Matrix([[0, 1]])
    given = S.transfer_function("theta_1", "T_T").mechanical
    assert (given - tn.load("amt_rig").symbolic().transfer_function("theta_1", "T_T").mechanical).equals(0)


@pytest.mark.parametrize(
    ("names", "words"),
    [(["motor", "primary"], "torque_meter"), (["hub"], "ground"), (["hubb"], 'did you mean "hub"')],
)
def test_impossible_coordinates_are_refused(names, words):
    with pytest.raises(tn.UsageError, match=words):
        tn.load("amt_rig").symbolic(referred_to=names)


def test_numbers_are_exact_rationals():
    K = tn.Drivetrain(
        "x", [tn.Inertia("j", node="a", inertia=0.1), tn.Spring("k", nodes=("a", "ground"), stiffness=0.5)]
    ).symbolic()
    assert (K.M[0], K.K[0]) == (Rational(1, 10), Rational(1, 2))


def test_matrices_in_symbols_equal_the_numbers():
    elements = [
        *(
            element
            for kind, element in EVERY_ELEMENT.items()
            if kind not in ("lock", "tabulated_spring", "continuous_shaft", "rigid_coupling")
        ),
    ]
    renamed = [type(e)(**{**vars(e), "name": f"e{i}"}) for i, e in enumerate(elements)]
    model = tn.Drivetrain(
        "all", [*renamed, tn.Inertia("jb", node="b", inertia="J"), tn.Inertia("jc", node="c", inertia=1)], {"J": 3}
    )
    S, system = model.symbolic(), model.assembly.system
    numbers = [np.array(matrix.subs(S.values).evalf(30).tolist(), dtype=float) for matrix in (S.M, S.C, S.K)]
    for symbolic, numeric in zip(numbers[:2], (system.M, system.C), strict=True):
        np.testing.assert_allclose(symbolic, numeric, rtol=1e-13)
    hysteretic = np.array(S.H.subs(S.values).evalf(30).tolist(), dtype=float)
    omega = 3.0
    kappa = system.kappa(omega)
    dynamic = system.rows.T @ (kappa[:, None] * system.rows)
    np.testing.assert_allclose(numbers[2] + 1j * hysteretic, system.K + dynamic, rtol=1e-13)


def test_condition_of_a_consistent_loop_is_recorded():
    model = tn.Drivetrain(
        "loop",
        [
            tn.Inertia("j", node="a", inertia="J"),
            tn.Gear("g1", nodes=("a", "b"), ratio="t1"),
            tn.Gear("g2", nodes=("b", "c"), ratio="t2"),
            tn.Gear("g3", nodes=("a", "c"), ratio="t3"),
        ],
        {"J": 1, "t1": 2, "t2": 3, "t3": 6},
    )
    t1, t2, t3 = sympy.symbols("t1 t2 t3")
    (condition,) = model.symbolic().conditions
    assert sympy.simplify(condition / (t1 * t2 - t3)) in (1, -1)


def test_tables_appear_as_functions_of_frequency():
    model = tn.Drivetrain(
        "t",
        [tn.Inertia("j", node="a", inertia=1), tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[1, 300, 2]])],
    )
    assert model.symbolic().tables[0] == sympy.Function("kappa_bush")(Symbol("omega"))


def test_equations_read_like_equations():
    lines = geared_line().symbolic().equations()
    assert lines[0] == "J_1 theta_m'' + c theta_m' - c theta_g' + k_1 theta_m - k_1 theta_g = T_M"
    assert lines[1].endswith("= 0")


def test_imposed_angles_stand_still_in_the_equations():
    elements = [tn.Inertia("j", node="a", inertia=1), tn.Spring("k", nodes=("a", "b"), stiffness="k")]
    model = tn.Drivetrain("x", elements, {"k": 3}, inputs={"phi": {"angle": "b"}})
    assert model.symbolic().equations() == ("theta_a'' + k theta_a = 0",)
