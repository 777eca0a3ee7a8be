"""Natural frequencies and damping ratios of variants: against modes of every variant, and two oscillators by hand."""

import itertools
import math

import numpy as np
import pytest
from support.study_blocks import amt_rig, columns, dmf_rig, ship, singly, spread, together

import torsionnet as tn
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.natural_frequency import MIXED
from torsionnet.study.quantities.quantity import QUANTITIES


@pytest.fixture
def model(request: pytest.FixtureRequest) -> tn.Drivetrain:
    """Made when a test asks for it: to read models takes much of collecting."""
    return request.param()


def made(kind: str, **entries: object) -> object:
    return QUANTITIES[kind](**entries)


def two_oscillators(coupling: float = 0.0, damping: float = 0.01) -> tn.Drivetrain:
    """Of 10 and 20 rad/s, each to ground."""
    elements = [
        tn.Inertia("J_a", node="a", inertia=1),
        tn.Inertia("J_b", node="b", inertia=1),
        tn.Spring("S_a", nodes=("a", "ground"), stiffness="k", damping=damping),
        tn.Spring("S_b", nodes=("b", "ground"), stiffness=400, damping=damping),
        tn.Spring("between", nodes=("a", "b"), stiffness=coupling or 1e-9),
    ]
    return tn.Drivetrain("two", elements, parameters={"k": 100.0})


def vibrations(model: tn.Drivetrain) -> np.ndarray:
    modes = model.modes()
    return modes.eigenvalues[[kind == OSCILLATORY for kind in modes.kinds]]


CASES = [
    (amt_rig, ("k_1", "c_O", "I_1"), 1),
    (dmf_rig, ("k_2", "I_1", "c_2"), 1),
    (dmf_rig, ("k_2", "I_1", "c_2"), 2),
    (ship, ("k_cpl", "water"), 1),
    (ship, ("k_cpl", "water"), 3),
]
HOW = [
    ("natural_frequency", {}, lambda value: abs(value) / (2 * math.pi)),
    ("natural_frequency", {"which": "damped", "order": "ascending"}, lambda value: value.imag / (2 * math.pi)),
    ("damping_ratio", {}, lambda value: -value.real / abs(value)),
]


@pytest.mark.few(2)
@pytest.mark.parametrize(("kind", "entries", "formula"), HOW)
@pytest.mark.parametrize(("model", "names", "mode"), CASES, indirect=["model"])
def test_a_mode_is_that_of_every_variant(
    model: tn.Drivetrain, names: tuple[str, ...], mode: int, kind: str, entries: dict[str, str], formula: object
) -> None:
    values = spread(model, names, count=3, width=0.05)
    quantity = made(kind, mode=mode, **entries)
    assert not list(quantity.model_faults(model, {}))
    expected = [formula(vibrations(model.configured(**own))[mode - 1]) for own in columns(values)]
    for block in (together(model, values), singly(model, values)):
        assert quantity.evaluate(block)[:, 0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("model", [amt_rig, dmf_rig, ship], indirect=True)
def test_undamped_natural_frequencies_count_from_the_lowest_vibration(model: tn.Drivetrain) -> None:
    (name,) = [name for name in ("k_1", "k_cpl") if name in model.parameters]
    values = spread(model, (name,), count=3)
    found = made("natural_frequency", mode=2, which="undamped").evaluate(together(model, values))[:, 0]
    for value, own in zip(found, columns(values), strict=True):
        rates = model.configured(**own).modes().undamped_natural_frequencies
        assert value == pytest.approx(rates[rates > 1e-6][1], rel=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize(("kind", "entries", "formula"), HOW)
@pytest.mark.parametrize("model", [amt_rig, ship], indirect=True)
def test_modes_do_not_depend_on_who_is_solved_along(
    model: tn.Drivetrain, kind: str, entries: dict[str, str], formula: object
) -> None:
    del formula
    (name,) = [name for name in ("k_1", "k_cpl") if name in model.parameters]
    values = spread(model, (name,), count=7, width=0.3)
    quantity = made(kind, mode=1, **entries)
    whole = quantity.evaluate(together(model, values))
    for cuts in ([0, 3, 7], range(8)):
        parts = [
            quantity.evaluate(together(model, {name: column[low:high] for name, column in values.items()}))
            for low, high in itertools.pairwise(cuts)
        ]
        assert np.array_equal(np.concatenate(parts), whole)


def test_a_mode_that_crosses_another_is_followed_by_its_shape() -> None:
    model, k = two_oscillators(), np.array([100.0, 225.0, 625.0, 900.0])
    asked = {
        "tracked": made("natural_frequency", mode=1),
        "ascending": made("natural_frequency", mode=1, order="ascending"),
        "undamped": made("natural_frequency", mode=1, which="undamped"),
        "zeta": made("damping_ratio", mode=1),
    }
    found = Evaluator(model, ("k",), asked)({"k": k})
    assert found["tracked"] == pytest.approx(np.sqrt(k) / (2 * math.pi), rel=1e-9)
    assert found["ascending"] == pytest.approx(np.minimum(np.sqrt(k), 20) / (2 * math.pi), rel=1e-9)
    assert found["undamped"] == pytest.approx(found["ascending"], rel=1e-9)
    assert found["zeta"] == pytest.approx(0.01 / (2 * np.sqrt(k)), rel=1e-9)


def test_modes_that_veer_keep_their_side_and_are_remarked() -> None:
    model = two_oscillators(coupling=20.0)
    block = together(model, {"k": np.array([100.0, 400.0, 900.0])})
    quantity = made("natural_frequency", mode=1)
    found = quantity.evaluate(block)[:, 0]
    for value, k in zip(found, (100.0, 400.0, 900.0), strict=True):
        lowest = np.linalg.eigvalsh([[k + 20, -20], [-20, 420]])[0]
        assert value == pytest.approx(math.sqrt(lowest) / (2 * math.pi), rel=1e-6)
    assert block.remarks[f"mode 1 {MIXED}"] >= 1


def test_a_mode_that_is_overdamped_in_a_variant_has_no_value_there() -> None:
    elements = [
        tn.Inertia("J", node="a", inertia=1),
        tn.Spring("S", nodes=("a", "ground"), stiffness=100, damping="c"),
    ]
    model = tn.Drivetrain("one", elements, parameters={"c": 1.0})
    asked = {kind: made(kind, mode=1) for kind in ("natural_frequency", "damping_ratio")}
    found = Evaluator(model, ("c",), asked)({"c": np.array([1.0, 19.0, 21.0])})
    assert found["natural_frequency"][:2] == pytest.approx([10 / (2 * math.pi)] * 2, rel=1e-9)
    assert found["damping_ratio"][:2] == pytest.approx([0.05, 0.95], rel=1e-9)
    assert np.isnan([column[2] for column in found.values()]).all()


def test_modes_of_variants_with_rows_of_their_own_are_solved_one_by_one() -> None:
    tau = np.array([7.96, 5.42, 4.14, 3.26])
    evaluator = Evaluator(
        amt_rig(), ("tau",), {"f": made("natural_frequency", mode=1), "zeta": made("damping_ratio", mode=1)}
    )
    assert evaluator.plan is None
    found = evaluator({"tau": tau})
    for number, gear in enumerate(("II", "III", "IV", "V")):
        value = vibrations(tn.load("amt_rig").configured(gear))[0]
        assert found["f"][number] == pytest.approx(abs(value) / (2 * math.pi), rel=1e-9)
        assert found["zeta"][number] == pytest.approx(-value.real / abs(value), rel=1e-9)


def test_variants_that_cannot_be_have_no_modes() -> None:
    for block in (
        together(dmf_rig(), {"k_2": np.array([400.0, -5.0])}),
        singly(dmf_rig(), {"k_2": np.array([400.0, -5.0])}),
    ):
        block.quantities["f"] = made("natural_frequency", mode=1)
        found = block.of("f")[:, 0]
        assert np.isfinite(found[0])
        assert np.isnan(found[1])
