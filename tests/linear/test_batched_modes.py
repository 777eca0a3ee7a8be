"""Modes of many variants at once against each variant by itself, closed forms and many digits."""

import random

import mpmath
import numpy as np
import pytest
from support import campaigns
from support.library_cases import library_cases
from support.random_drivetrains import draw

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import batched_modes, single_modes
from torsionnet.linear.modes.natural_modes import natural_modes

LIBRARY = [
    "amt_rig",
    "direct_drive_wind_turbine",
    "dmf_rig",
    "drill_string",
    "engine_generator_set",
    "front_wheel_drive_car",
    "geared_branch",
    "marine_medium_speed",
    "marine_steam_turbine",
    "oil_engine",
    "planetary_set",
    "reciprocating_compressor_train",
    "six_cylinder_diesel",
    "turbine_generator_ssr",
    "two_stroke_ship",
    "wind_turbine_3mw",
    "wind_turbine_5mw",
]


def basic(model):
    """Parameters that rows do not depend on."""
    known = [
        name for name, one in model.parameter_definitions.items() if not one.value.names and model.parameters[name]
    ]
    return [name for name in known if batch_plan(model, [name]) is not None]


def scattered(model, count, spread=0.2, seed=1):
    source, names = np.random.default_rng(seed), basic(model)
    values = {name: model.parameters[name] * np.exp(spread * source.standard_normal(count)) for name in names}
    return batch_plan(model, names).batch(values)


def assert_as_single(found, place, single):
    own = ~np.isnan(found.eigenvalues[place])
    assert np.count_nonzero(own) == len(single)
    assert own[: len(single)].all()
    assert found.natural_frequencies[place, own] == pytest.approx(single.natural_frequencies, rel=1e-9)
    assert found.damping_ratios[place, own] == pytest.approx(single.damping_ratios, abs=1e-9, nan_ok=True)
    assert ((found.eigenvalues[place, own].imag == 0) == (single.eigenvalues.imag == 0)).all()
    assert np.abs(found.shapes[place][:, own] - single.shapes).max() < 1e-6
    undamped = found.undamped_natural_frequencies[place]
    assert undamped[~np.isnan(undamped)] == pytest.approx(single.undamped_natural_frequencies, rel=1e-9)


def assert_all_as_single(batch, found):
    for place in np.flatnonzero(~batch.impossible):
        assert_as_single(found, place, natural_modes(batch.model(place))[0])


@pytest.mark.few(3)
@pytest.mark.parametrize("name", library_cases(LIBRARY))
def test_library_models_as_each_variant_by_itself(name):
    model = tn.load(name)
    for choice in (model.configurations or (None,))[:: campaigns.examples(100, 1)]:
        case = model.configured(choice) if choice else model
        batch = scattered(case, 3)
        found = batched_modes(batch)
        assert_all_as_single(batch, found)
        assert (
            found.uncertain.all() if name == "planetary_set" else not found.uncertain.all()
        )  # its planets' modes are equal


@pytest.mark.few(4, 10)
@pytest.mark.parametrize("seed", range(campaigns.examples(30, 300)))
def test_random_drivetrains_as_each_variant_by_itself(seed):
    """Trees and loops with gears, massless nodes, hysteretic springs and planetary sets."""
    source = random.Random(seed)
    try:
        model, _ = draw(source, loops=seed % 3, planetary=seed % 5 == 0)
        _ = model.modes()
    except tn.TorsionnetError:
        return
    batch = scattered(model, 4, spread=0.5, seed=seed)
    assert_all_as_single(batch, batched_modes(batch))


def test_overdamped_and_driven_vibrations_by_their_closed_form():
    """J s^2 + c s + k = 0: pairs, real poles and damping below zero side by side."""
    model = tn.Drivetrain(
        "one",
        [
            tn.Inertia("disc", node="a", inertia=0.5),
            tn.Spring("spring", nodes=("a", "ground"), stiffness=200),
            tn.ConstantPowerLoad("load", node="a", power="P", speed=1),  # c = -P
        ],
        {"P": -1.0},
    )
    c = np.array([1.0, 10.0, 19.0, 21.0, 60.0, -3.0, -25.0])
    found = batched_modes(batch_plan(model, ["P"]).batch({"P": -c}))
    for place, value in enumerate(c):
        roots = np.roots([0.5, value, 200.0])
        known = sorted(roots[roots.imag >= 0], key=abs)
        own = found.eigenvalues[place][~np.isnan(found.eigenvalues[place])]
        assert own == pytest.approx(known, rel=1e-12)
    assert np.isnan(found.eigenvalues[0, 1])
    assert found.undamped_natural_frequencies * 2 * np.pi == pytest.approx(np.full((7, 1), 20.0), rel=1e-14)
    assert not found.uncertain.any()


def test_hysteretic_springs_by_their_closed_form():
    """det(lambda^2 M + K) = 0 with K complex, which no frequency changes: lambda = j sqrt(kappa) of M^-1 K."""
    model = tn.Drivetrain(
        "rubber",
        [
            tn.Inertia("disc_a", node="a", inertia="J"),
            tn.Inertia("disc_b", node="b", inertia=2.0),
            tn.Spring("to_ground", nodes=("a", "ground"), stiffness=1e3),
            tn.HystereticSpring("coupling", nodes=("a", "b"), stiffness="k", loss_factor="eta"),
        ],
        {"J": 0.5, "k": 400.0, "eta": 0.1},
    )
    source = np.random.default_rng(4)
    values = {name: value * np.exp(0.4 * source.standard_normal(20)) for name, value in model.parameters.items()}
    found = batched_modes(batch_plan(model, list(values)).batch(values))
    assert not found.uncertain.any()
    for place in range(20):
        k = values["k"][place] * (1 + 1j * values["eta"][place])
        squares = np.linalg.eigvals(np.diag([1 / values["J"][place], 0.5]) @ np.array([[1e3 + k, -k], [-k, k]]))
        known = np.sort_complex(1j * np.sqrt(squares))
        assert np.sort_complex(found.eigenvalues[place]) == pytest.approx(known, rel=1e-12)


def chain(masses, springs, dampers=(), grounded=False):
    """A chain whose numbers are parameters J_i, k_i, c_i; ``grounded``: the last spring goes to ground."""
    elements = [tn.Inertia(f"J{i}", node=f"n{i}", inertia=f"J_{i}") for i in range(len(masses))]
    for i in range(len(springs)):
        end = "ground" if grounded and i == len(springs) - 1 else f"n{i + 1}"
        damping = f"c_{i}" if dampers else 0
        elements.append(tn.Spring(f"k{i}", nodes=(f"n{i}", end), stiffness=f"k_{i}", damping=damping))
    lists = {"J": masses, "k": springs, "c": dampers}
    return tn.Drivetrain(
        "chain", elements, {f"{a}_{i}": float(x) for a, row in lists.items() for i, x in enumerate(row)}
    )


def exact_poles(batch, place):
    """Eigenvalues with Im >= 0 of M s^2 + C s + K in 60 digits, zeros left out."""
    system = batch.drivetrain.assembly.system
    with mpmath.workdps(60):
        rows = mpmath.matrix(system.rows.tolist())
        M, C, K = (
            rows.T * mpmath.diag([mpmath.mpf(float(x)) for x in part[place]]) * rows
            for part in (batch.inertia, batch.damping, batch.stiffness)
        )
        n = M.rows
        A, inverse = mpmath.zeros(2 * n), M**-1
        A[:n, n:] = mpmath.eye(n)
        A[n:, :n], A[n:, n:] = -inverse * K, -inverse * C
        values = mpmath.eig(A, left=False, right=False)
        tiny = mpmath.mpf(10) ** -22 * max(map(abs, values))  # a double zero comes out as the root of the precision
        return sorted((complex(z) for z in values if abs(z) > tiny and mpmath.im(z) >= -tiny), key=abs)


@pytest.mark.few(1)
@pytest.mark.parametrize("grounded", [False, True])
def test_stiff_chains_are_doubtful_and_right(grounded):
    """Springs of 1e2 and of 1e10 N m/rad in one chain, where double precision has lost the slow modes."""
    springs = [1e2, 1e10, 1e6, 1e10, *([1e2] if grounded else [])]
    model = chain([1e2, 1.0, 10.0, 1e-2, 1e3], springs, grounded=grounded)
    source = np.random.default_rng(3)
    values = {name: value * np.exp(0.3 * source.standard_normal(3)) for name, value in model.parameters.items()}
    batch = batch_plan(model, list(values)).batch(values)
    found = batched_modes(batch)
    assert found.uncertain.all()
    for place in range(3):
        known = np.abs(exact_poles(batch, place)) / (2 * np.pi)
        own = found.natural_frequencies[place]
        assert own[own > 0] == pytest.approx(known, rel=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(campaigns.examples(8, 60)))
def test_what_is_not_doubtful_is_right_whatever_the_numbers(seed):
    """Inertias and stiffnesses that differ by up to nine decades, light and heavy damping, against 60 digits."""
    source = np.random.default_rng(seed)
    n, decades = 4, source.uniform(0, 9)
    draw_row = lambda middle, count: middle * 10 ** source.uniform(-decades / 2, decades / 2, count)  # noqa: E731
    model = chain([1.0] * n, [1e4] * n, [1.0] * n, grounded=True)
    rows = {"J": (1.0, n), "k": (1e4, n), "c": (10 ** source.uniform(-3, 2), n)}
    columns = {f"{a}_{i}": draw_row(middle, 6) for a, (middle, count) in rows.items() for i in range(count)}
    batch = batch_plan(model, list(columns)).batch(columns)
    found = batched_modes(batch)
    for place in range(6):
        known = np.array(exact_poles(batch, place))
        own = found.eigenvalues[place][~np.isnan(found.eigenvalues[place])]
        assert len(own) == len(known)
        apart = np.abs(own - known[np.argmin(np.abs(own[:, None] - known), axis=1)]) / np.abs(own)
        assert apart.max() < 1e-9, found.uncertain[place]


def test_massless_nodes_by_their_closed_form():
    """A disc on a spring to a massless node on a damper: J c s^2 + J k s + k c = 0, slow and fast by up to 1e14."""
    model = tn.Drivetrain(
        "massless",
        [
            tn.Inertia("disc", node="a", inertia="J"),
            tn.Spring("spring", nodes=("a", "b"), stiffness="k"),
            tn.Damper("damper", nodes=("b", "ground"), damping="c"),
        ],
        {"J": 1e3, "k": 1e4, "c": 1.0},
    )
    k, c = (grid.ravel() for grid in np.meshgrid(np.geomspace(1e2, 1e9, 8), np.geomspace(1e-2, 1e6, 9)))
    found = batched_modes(batch_plan(model, ["k", "c"]).batch({"k": k, "c": c}))
    assert 0 < found.uncertain.sum() < len(k)
    for place in range(len(k)):
        with mpmath.workdps(50):
            quadratic = [mpmath.mpf(1000) * c[place], mpmath.mpf(1000) * k[place], mpmath.mpf(k[place]) * c[place]]
            roots = [complex(root) for root in mpmath.polyroots(quadratic, maxsteps=200, extraprec=200)]
        known = sorted((root for root in roots if root.imag >= 0), key=abs)
        own = found.eigenvalues[place]
        assert own[np.abs(own) > 0] == pytest.approx(known, rel=1e-9)


def test_a_massless_node_between_two_dampers_by_its_closed_form():
    """Dampers one behind the other: J s^2 + c s + k = 0 with 1/c = 1/c_1 + 1/c_2."""
    model = tn.Drivetrain(
        "in series",
        [
            tn.Inertia("disc", node="a", inertia=0.5),
            tn.Spring("spring", nodes=("a", "ground"), stiffness=200),
            tn.Damper("first", nodes=("a", "n"), damping="c_1"),
            tn.Damper("second", nodes=("n", "ground"), damping="c_2"),
        ],
        {"c_1": 1.0, "c_2": 1.0},
    )
    c_1, c_2 = np.array([1.0, 4.0, 30.0, 80.0]), np.array([3.0, 4.0, 2.0, 120.0])
    found = batched_modes(batch_plan(model, ["c_1", "c_2"]).batch({"c_1": c_1, "c_2": c_2}))
    for place, c in enumerate(c_1 * c_2 / (c_1 + c_2)):
        roots = np.roots([0.5, c, 200.0])
        own = found.eigenvalues[place][np.abs(found.eigenvalues[place]) > 1e-9]
        assert own == pytest.approx(sorted(roots[roots.imag >= 0], key=abs), rel=1e-12)
    assert not found.uncertain.any()  # or they would be solved one by one


def star(branches):
    parts = [tn.Inertia("hub", node="h", inertia=0.3)]
    for i in range(branches):
        parts += [
            tn.Spring(f"spring_{i}", nodes=("h", f"b{i}"), stiffness="k", damping="c"),
            tn.Inertia(f"disc_{i}", node=f"b{i}", inertia=0.1),
        ]
    return tn.Drivetrain("star", parts, {"k": 100.0, "c": 0.3})


def test_equal_branches_have_the_shapes_that_single_models_choose():
    model = star(3)
    batch = batch_plan(model, ["k", "c"]).batch({"k": np.array([80.0, 100.0]), "c": np.array([0.0, 0.3])})
    found = batched_modes(batch)
    assert found.uncertain.all()
    assert_all_as_single(batch, found)
    branch = np.sort(np.roots([0.1, 0.3, 100.0]).imag)[-1]
    assert np.sort(np.abs(found.eigenvalues[1].imag - branch))[:2] == pytest.approx([0, 0], abs=1e-9)


def mixed_block():
    """Variants with light and with too much damping, and some that are doubtful."""
    source = np.random.default_rng(7)
    model = chain([1.0, 0.5, 2.0, 0.3], [1e4, 2e4, 3e4], [1.0, 2.0, 3.0])
    values = {name: value * np.exp(0.2 * source.standard_normal(60)) for name, value in model.parameters.items()}
    values["c_1"][::7] *= 300.0
    values["k_0"][5::20] *= 1e12
    return batch_plan(model, list(values)), values


def rubber_block():
    """The same with hysteretic springs, some of which are damped so much that there are real poles."""
    source = np.random.default_rng(8)
    model = tn.Drivetrain(
        "rubber",
        [
            *(tn.Inertia(f"J{i}", node=f"n{i}", inertia="J") for i in range(3)),
            tn.HystereticSpring("rubber", nodes=("n0", "n1"), stiffness="k", loss_factor="eta"),
            tn.Spring("shaft", nodes=("n1", "n2"), stiffness=2e4, damping="c"),
            tn.Spring("stop", nodes=("n2", "ground"), stiffness=1e2),
        ],
        {"J": 0.5, "k": 1e4, "eta": 0.1, "c": 1.0},
    )
    values = {name: value * np.exp(0.2 * source.standard_normal(60)) for name, value in model.parameters.items()}
    values["c"][::7] *= 500.0
    values["k"][5::20] *= 1e12
    return batch_plan(model, list(values)), values


@pytest.mark.parametrize("block", [mixed_block, rubber_block])
def test_bits_do_not_depend_on_the_neighbours(block):
    plan, values = block()
    whole = batched_modes(plan.batch(values))
    assert np.any(np.isnan(whole.eigenvalues))
    assert 0 < whole.uncertain.sum() < 10
    for size in (1, 2, 3, 7, 31):
        for start in range(0, 60, size):
            some = slice(start, start + size)
            part = batched_modes(plan.batch({name: column[some] for name, column in values.items()}))
            width = part.eigenvalues.shape[1]
            assert np.isnan(whole.eigenvalues[some, width:]).all()
            assert part.eigenvalues.tobytes() == whole.eigenvalues[some, :width].tobytes()
            assert part.shapes.tobytes() == whole.shapes[some][:, :, :width].tobytes()
            rates = whole.undamped_natural_frequencies[some, : part.undamped_natural_frequencies.shape[1]]
            assert part.undamped_natural_frequencies.tobytes() == rates.tobytes()
            assert (part.uncertain == whole.uncertain[some]).all()


def test_impossible_variants_have_no_modes_and_others_keep_theirs():
    model = chain([1.0, 0.5], [1e4], [1.0])
    batch = batch_plan(model, ["k_0", "c_0"]).batch(
        {"k_0": np.array([1e4, -1.0, np.nan, 1e4]), "c_0": np.array([1.0, 1.0, 1.0, 0.0])}
    )
    found = batched_modes(batch)
    assert np.isnan(found.eigenvalues).all(axis=1).tolist() == [False, True, True, False]
    assert_all_as_single(batch, found)
    assert found.damping_ratios[3, 1] == 0


def test_variants_with_other_rows_are_solved_one_by_one():
    model = tn.load("amt_rig")
    values = {"tau": np.array([3.0, 5.0]), "c_O": np.array([100.0, 200.0])}
    found = single_modes(model, values)
    assert found.uncertain.all()
    for place in range(2):
        one = model.configured(**{name: column[place] for name, column in values.items()})
        assert_as_single(found, place, natural_modes(one)[0])


def test_a_variant_without_modes_is_named_and_stops_no_other():
    model = chain([1.0, 0.5], [1e4])
    found = single_modes(model, {"J_0": np.array([1.0, -2.0, 3.0])})
    assert np.isnan(found.eigenvalues).all(axis=1).tolist() == [False, True, False]
    assert len(found.notes) == 1
    assert "variant 2" in found.notes[0]
    with pytest.raises(ModelError):
        model.configured(J_0=-2.0)


def test_a_matrix_that_lapack_gives_up_on_costs_the_others_nothing(monkeypatch):
    plan, values = mixed_block()
    batch = plan.batch(values)
    before, eig = batched_modes(batch), np.linalg.eig
    stuck = []

    def failing(stack):
        if not stuck:
            stuck.append(stack[17].copy())
        if stack.ndim == 3 and (stack == stuck[0]).all(axis=(1, 2)).any():
            raise np.linalg.LinAlgError("Eigenvalues did not converge")
        return eig(stack)

    monkeypatch.setattr(np.linalg, "eig", failing)
    after = batched_modes(batch)
    changed = before.uncertain != after.uncertain
    assert changed.sum() == 1
    assert after.eigenvalues[~changed].tobytes() == before.eigenvalues[~changed].tobytes()
    assert after.eigenvalues[changed] == pytest.approx(before.eigenvalues[changed], rel=1e-9, nan_ok=True)
