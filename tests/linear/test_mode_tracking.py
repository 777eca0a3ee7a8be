"""Modes followed across variants: closed forms of crossing and veering, and dense continuation."""

import numpy as np
import pytest
import scipy
from support import campaigns

import torsionnet as tn
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_modes import batched_modes, single_modes
from torsionnet.linear.batch.mode_steps import MISSING_MODE, FollowedModes, assign_modes
from torsionnet.linear.batch.mode_tracking import track_modes


def followed(model, values):
    values = {name: np.asarray(column, dtype=float) for name, column in values.items()}
    return track_modes(batched_modes(batch_plan(model, list(values)).batch(values)))


def squares(found):
    return (2 * np.pi * found.natural_frequencies) ** 2


def coupled(coupling, kind=tn.Spring, **more):
    """Two discs of 1 kg m^2 on springs k_a and 200 to ground, coupled by a third."""
    return tn.Drivetrain(
        "coupled",
        [
            tn.Inertia("disc_a", node="a", inertia=1),
            tn.Inertia("disc_b", node="b", inertia=1),
            tn.Spring("spring_a", nodes=("a", "ground"), stiffness="k_a"),
            tn.Spring("spring_b", nodes=("b", "ground"), stiffness=200),
            kind("coupling", nodes=("a", "b"), stiffness=coupling, **more),
        ],
        {"k_a": 100.0},
    )


K_A = np.linspace(80, 320, 25)


def veering(k_a, coupling):
    """Squares of both frequencies, and the angle of the lower shape against the first disc."""
    half, mean = (k_a - 200) / 2, (k_a + 200) / 2 + coupling
    root = np.hypot(half, coupling)
    return np.stack([mean - root, mean + root], axis=-1), 0.5 * np.arctan2(coupling, -half)


@pytest.mark.parametrize("coupling", [0.3, 3.0, 30.0])
def test_veering_modes_stay_on_their_sides_and_are_marked(coupling):
    found = followed(coupled(coupling), {"k_a": K_A})
    known, angle = veering(K_A, coupling)
    assert squares(found) == pytest.approx(known, rel=1e-9)
    mac = np.cos(angle - veering(100.0, coupling)[1]) ** 2
    assert found.mac == pytest.approx(np.stack([mac, mac], axis=1), abs=1e-9)
    assert (found.veering == (1 - mac >= 0.2)[:, None]).all()
    least = 100 * np.min((known[:, 1] / known[:, 0])[found.veering[:, 0]] ** 0.5 - 1)
    assert found.notes == (
        f"modes 1 and 2 share or exchange their shapes in {found.veering[:, 0].sum()} of 25 variants; "
        f"they come within {100 * (1 - 1 / (1 + least / 100)):.2g} % of each other",
    )


def test_a_veering_too_narrow_to_see_is_a_crossing():
    """Frequencies that would come within 5e-9 of each other: the shapes are what lasts."""
    coupling = 1e-6
    k_a = K_A + 1.3  # not where they meet
    found = followed(coupled(coupling), {"k_a": k_a})
    known, _ = veering(k_a, coupling)
    swapped = np.where((k_a > 200)[:, None], known[:, ::-1], known)
    assert squares(found) == pytest.approx(swapped, rel=1e-9)
    assert found.mac == pytest.approx(np.ones((25, 2)), abs=1e-9)
    assert not found.veering.any()


def twins():
    """Equal branches on a hub, and a disc behind it: modes in which the hub rests cross those in which it turns."""
    return tn.Drivetrain(
        "twins",
        [
            tn.Inertia("hub", node="h", inertia=1.0),
            tn.Inertia("left", node="l", inertia=0.5),
            tn.Inertia("right", node="r", inertia=0.5),
            tn.Inertia("disc", node="d", inertia="J"),
            tn.Spring("to_left", nodes=("h", "l"), stiffness=100),
            tn.Spring("to_right", nodes=("h", "r"), stiffness=100),
            tn.Spring("to_disc", nodes=("h", "d"), stiffness=150),
            tn.Spring("to_ground", nodes=("d", "ground"), stiffness=150),
        ],
        {"J": 0.7},
    )


@pytest.mark.parametrize("home", [0.7, 4.0])
def test_modes_that_cross_keep_their_shapes(home):
    """The branches against each other, k/J = 200, and three modes with both alike: a matrix of three by three."""
    inertia = np.geomspace(0.5, 6.0, 20)
    found = followed(twins().configured(J=home), {"J": inertia})

    def alike(J):
        K = np.array([[350, -200, -150], [-200, 200, 0], [-150, 0, 300]])
        scale = 1 / np.sqrt([1.0, 1.0, J])
        return np.linalg.eigvalsh(scale[:, None] * K * scale)

    own = np.array([alike(J) for J in inertia])
    apart = int(np.argmin(np.abs(squares(followed(twins().configured(J=home), {"J": [home]}))[0] - 200)))
    assert squares(found)[:, apart] == pytest.approx(np.full(20, 200.0), rel=1e-12)
    assert np.delete(squares(found), apart, axis=1) == pytest.approx(own, rel=1e-9)
    assert found.mac[:, apart] == pytest.approx(np.ones(20), abs=1e-9)
    assert not found.veering[:, apart].any()
    order = np.argsort(found.natural_frequencies, axis=1)
    assert len({tuple(row) for row in order.tolist()}) > 1  # some do cross


def test_critical_damping_is_passed_both_ways():
    """J s^2 + c s + k = 0: a vibration goes on as the slower one of its real poles, and two of these as one."""
    elements = [
        tn.Inertia("disc", node="a", inertia=0.5),
        tn.Spring("spring", nodes=("a", "ground"), stiffness=200, damping="c"),
    ]
    model = tn.Drivetrain("one", elements, {"c": 2.0})
    c = np.array([1.0, 10.0, 19.99, 20.01, 21.0, 60.0])
    roots = [sorted(np.roots([0.5, value, 200.0]), key=lambda z: (abs(z), -z.imag)) for value in c]
    found = followed(model, {"c": c})
    assert found.eigenvalues[:, 0] == pytest.approx([pair[0] for pair in roots], rel=1e-9)
    assert found.damping_ratios[3:, 0].tolist() == [1, 1, 1]
    assert any("beyond critical damping in 3 of 6 variants" in note for note in found.notes)
    back = followed(model.configured(c=70), {"c": c})
    assert back.eigenvalues[:, 0] == pytest.approx([pair[0] for pair in roots], rel=1e-9)
    assert back.eigenvalues[3:, 1] == pytest.approx([pair[1] for pair in roots[3:]], rel=1e-9)
    assert np.isnan(back.eigenvalues[:3, 1]).all()
    assert "a real pole has no successor in 3 of 6 variants" in back.notes


@pytest.mark.parametrize(
    ("eigenvalue", "share_of_slower", "goes_on"),
    [(-15 + 1j, 0.55, [0, MISSING_MODE]), (-15 + 1j, 0.3, [MISSING_MODE, 0]), (-15, 0.55, [MISSING_MODE, 0])],
)
def test_only_a_vibration_that_two_real_poles_make_continues_the_slower(eigenvalue, share_of_slower, goes_on):
    """Its state has more of the faster pole, 0.9 of the energy, so that alone would be followed."""
    shares = np.sqrt([[share_of_slower], [0.9]])
    known = FollowedModes(np.array([[-10.0 + 0j, -20]]), np.eye(2, dtype=complex)[None])
    assert assign_modes(known, FollowedModes(np.array([[eigenvalue + 0j]]), shares[None] + 0j)).tolist() == [goes_on]


def damped_chain(source, n):
    elements, parameters = [], {}
    for i in range(n):
        parameters |= {f"J_{i}": source.uniform(0.3, 2), f"k_{i}": source.uniform(5e3, 3e4)}
        parameters[f"c_{i}"] = source.uniform(0.1, 3)
        before = "ground" if i == 0 else f"n{source.integers(i)}"
        elements += [
            tn.Inertia(f"J{i}", node=f"n{i}", inertia=f"J_{i}"),
            tn.Spring(f"k{i}", nodes=(before, f"n{i}"), stiffness=f"k_{i}", damping=f"c_{i}"),
        ]
    return tn.Drivetrain("tree", elements, parameters)


def densely_followed(model, ends, count):
    """Eigenvalues with Im > 0 at the end of a straight way in logarithms, each next to where the last steps point."""
    system = model.assembly.system
    names = list(ends)
    start = np.array([model.parameters[name] for name in names])
    way = start * (np.array([ends[name] for name in names]) / start) ** np.linspace(0, 1, count)[:, None]
    batch = batch_plan(model, names).batch(dict(zip(names, way.T, strict=True)))
    rows, n = system.rows, system.n_coordinates
    M, C, K = (rows.T @ (part[:, :, None] * rows) for part in (batch.inertia, batch.damping, batch.stiffness))
    A = np.zeros((count, 2 * n, 2 * n))
    A[:, :n, n:] = np.eye(n)
    A[:, n:, :n], A[:, n:, n:] = -np.linalg.solve(M, K), -np.linalg.solve(M, C)
    values = np.linalg.eigvals(A)
    last = before = np.array(sorted(values[0][values[0].imag > 0], key=abs))
    for here in values[1:]:
        vibrating = here[here.imag > 0]
        ahead = 2 * last - before
        before, last = last, vibrating[scipy.optimize.linear_sum_assignment(np.abs(ahead[:, None] - vibrating))[1]]
    return last


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(campaigns.examples(4, 40)))
def test_random_trees_against_dense_continuation(seed):
    source = np.random.default_rng(seed)
    model = damped_chain(source, 5)
    count = 6
    values = {name: value * np.exp(0.5 * source.standard_normal(count)) for name, value in model.parameters.items()}
    found = followed(model, values)
    for place in range(count):
        known = densely_followed(model, {name: column[place] for name, column in values.items()}, 3000)
        assert found.eigenvalues[place] == pytest.approx(known, rel=1e-6), (seed, place)


@pytest.mark.slow
def test_a_variant_is_followed_alike_whatever_its_neighbours():
    source = np.random.default_rng(2)
    model = damped_chain(source, 5)
    values = {name: value * np.exp(0.6 * source.standard_normal(24)) for name, value in model.parameters.items()}
    whole = followed(model, values)
    for size in (1, 5):
        for start in range(0, 24, size):
            some = slice(start, start + size)
            part = followed(model, {name: column[some] for name, column in values.items()})
            for name in ("columns", "mac", "veering", "eigenvalues", "shapes"):
                assert getattr(part, name).tobytes() == getattr(whole, name)[some].tobytes()


def test_equal_modes_that_part_are_each_given_to_one():
    """Three equal branches of which one becomes stiffer: those two modes of the drivetrain are any two."""
    parts = [tn.Inertia("hub", node="h", inertia=0.3)]
    for i in range(3):
        parts += [
            tn.Spring(f"spring_{i}", nodes=("h", f"b{i}"), stiffness=f"k_{i}"),
            tn.Inertia(f"disc_{i}", node=f"b{i}", inertia=0.1),
        ]
    model = tn.Drivetrain("star", parts, {f"k_{i}": 100.0 for i in range(3)})
    found = followed(model, {"k_0": [100.0, 101.0, 130.0], "k_1": [100.0, 99.0, 60.0]})
    assert np.sort(found.columns, axis=1).tolist() == [[0, 1, 2, 3]] * 3
    assert found.natural_frequencies[0] == pytest.approx(model.modes().natural_frequencies, rel=1e-9)


def test_laws_over_frequency_and_other_rows_are_followed_singly():
    """A rubber coupling; and a ratio that changes rows, where the way is over drivetrains too."""
    found = followed(coupled(3.0, tn.HystereticSpring, loss_factor=0.01), {"k_a": K_A[::6]})
    known, _ = veering(K_A[::6], 3.0)
    assert squares(found) == pytest.approx(known, rel=1e-3)
    assert found.modes.uncertain.all()
    rig = tn.load("amt_rig")
    values = {"tau": np.array([3.26, 4.14, 7.96])}
    ratios = track_modes(single_modes(rig, values))
    for place, tau in enumerate(values["tau"]):
        assert np.sort(ratios.natural_frequencies[place]) == pytest.approx(
            rig.configured(tau=tau).modes().natural_frequencies
        )


def test_variants_that_cannot_be_have_no_modes_in_any_place():
    found = followed(coupled(3.0), {"k_a": [100.0, -50.0, 300.0]})
    assert (found.columns[1] == -1).all()
    assert np.isnan(found.natural_frequencies[1]).all()
    assert np.isnan(found.mac[1]).all()
    assert not found.veering[1].any()
    assert not any("successor" in note for note in found.notes)
