"""Modes as a result: words, energies, tables, warnings."""

import json
from itertools import pairwise

import numpy as np
import pytest
from support.models import geared_line

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.linear.modes import frozen_stiffness
from torsionnet.linear.modes.eigen import undamped_modes
from torsionnet.linear.modes.spectrum import Mode


def test_energy_shares_by_hand():
    """Two equal inertias on a spring: each has half the kinetic energy, the spring all of the strain."""
    model = tn.Drivetrain(
        "two",
        [
            tn.Inertia("a", node="a", inertia=2),
            tn.Spring("k", nodes=("a", "b"), stiffness=8, damping=0.1),
            tn.Inertia("b", node="b", inertia=2),
        ],
    )
    shares = model.modes().energy_shares(1)
    assert shares["a"] == pytest.approx((0.5, 0, 0))
    assert shares["k"] == pytest.approx((0, 1, 1))


def test_words_about_modes():
    rigid, first, second = (
        tn.Drivetrain(
            "three",
            [
                *(tn.Inertia(f"j{n}", node=n, inertia=1) for n in "abc"),
                tn.Spring("left", nodes=("a", "b"), stiffness=100),
                tn.Spring("right", nodes=("b", "c"), stiffness=100),
            ],
        )
        .modes()
        .descriptions
    )
    assert rigid == "rigid-body rotation"
    assert first == "strain in left 50 %, right 50 %; 1 node of vibration at b"
    assert second == "strain in left 50 %, right 50 %; 2 nodes of vibration in left, in right"


def test_nodes_of_vibration_are_counted_over_the_gears():
    """The n-th elastic mode of a tree has n nodes; two branches of two gear stages each meet at the bull gear."""
    described = tn.load("marine_steam_turbine").modes().descriptions[2:]
    counts = [int(text.split("; ")[1].split()[0]) for text in described]
    assert counts == [1, 2, 3, 4, 5]
    assert not any("node of vibration" in text for text in tn.load("planetary_set").modes().descriptions)


def test_overdamped_mode_has_ratio_one_and_a_time_constant():
    modes = tn.load("amt_rig").configured("V", c_O=360).modes()
    assert modes.kinds == ("oscillatory", "real pole", "real pole")
    assert modes.damping_ratios[1:].tolist() == [1, 1]
    assert "time constant 0.0222 s" in modes.descriptions[1]


def test_rigid_body_has_no_damping_ratio():
    modes = geared_line().switched(off=["brake", "stiff"]).modes()
    assert modes.kinds[0] == "rigid body"
    assert (modes.natural_frequencies[0], np.isnan(modes.damping_ratios[0])) == (0, True)


def test_every_form_of_the_table_holds_the_same_numbers(tmp_path):
    modes = tn.load("dmf_rig").modes()
    modes.to_csv(tmp_path / "modes.csv")
    lines = [line for line in (tmp_path / "modes.csv").read_text().splitlines() if not line.startswith("#")]
    assert float(lines[1].split(",")[1]) == modes.natural_frequencies[0]
    data = json.loads(modes.table().to_json())
    assert data["rows"][0][1] == modes.natural_frequencies[0]
    assert data["columns"][1]["unit"] == "Hz"
    assert "7.10526" in modes.table().to_text()
    assert "<td>7.10526</td>" in modes._repr_html_()
    assert repr(modes) == "<Modes: 2 modes at 7.105, 80.98 Hz>"


def test_conventions_change_what_is_shown():
    modes = tn.load("dmf_rig").modes()
    table = modes.table(tn.Conventions(frequency="cpm"))
    assert table.columns[1].unit == "cpm"
    assert table.rows[0][1] == pytest.approx(60 * modes.natural_frequencies[0])


def test_shapes_cover_eliminated_nodes():
    modes = geared_line().modes()
    np.testing.assert_allclose(modes.shape_at("o"), modes.shape_at("g") / 3, rtol=1e-13)
    np.testing.assert_allclose(modes.shape_at("p"), modes.shape_at("m"), rtol=1e-13)
    assert np.abs(modes.shapes).max(axis=0) == pytest.approx(1)
    with pytest.raises(tn.UsageError, match="no node"):
        modes.shape_at("M")


@pytest.mark.parametrize(("low", "high", "settles"), [(30, 60, True), (60, 30, False)])
def test_law_without_fixed_point_is_reported(low, high, settles):
    """Where a stiffness drops just above the frequency it would give, the mode runs from its own table."""
    table = [[0.1, low, 0], [1.0, low, 0], [1.000001, high, 0], [9, high, 0]]
    bush = tn.TabulatedSpring("k", nodes=("a", "ground"), table=table)
    model = tn.Drivetrain("t", [tn.Inertia("j", node="a", inertia=1), bush])
    if settles:
        assert model.modes().converged.all()
    else:
        with pytest.warns(tn.TorsionnetWarning, match="did not settle"):
            assert not model.modes().converged[0]


def test_a_table_that_feeds_energy_makes_an_unstable_mode():
    """lambda^2 + c lambda + k = 0 with c = -1 frozen at the mode's own frequency."""
    bush = tn.TabulatedSpring("b", nodes=("a", "ground"), table=[[0, 100, -1.0], [50, 100, -1.0]])
    modes = tn.Drivetrain("t", [tn.Inertia("j", node="a", inertia=1), bush]).modes()
    assert modes.eigenvalues[0].real == pytest.approx(0.5, rel=1e-2)
    assert modes.damping_ratios[0] == pytest.approx(-0.05, rel=1e-2)
    assert modes.descriptions[0].startswith("unstable, it grows")


def test_warnings_point_at_the_line_of_the_user():
    free = geared_line().switched(off=["brake", "stiff"])
    with pytest.warns(tn.TorsionnetWarning) as caught:
        free.frequency_response("angle", "T_M", [0.0])
    assert caught[0].filename == __file__


def test_without_damping_the_natural_frequencies_are_the_undamped_ones():
    elements = [
        tn.Inertia("a", node="a", inertia=1),
        tn.Spring("ab", nodes=("a", "b"), stiffness=3e3),
        tn.Spring("bc", nodes=("b", "c"), stiffness=1e3),  # b has no inertia
        tn.Inertia("c", node="c", inertia=2),
        tn.Gear("cd", nodes=("c", "d"), ratio=-3),
        tn.Inertia("d", node="d", inertia=0.2),
    ]
    modes = tn.Drivetrain("free", elements).modes()
    expected = undamped_modes(tn.Drivetrain("free", elements).assembly.system)[0] / (2 * np.pi)
    assert modes.undamped_natural_frequencies == pytest.approx(expected, rel=1e-14, abs=0)
    assert len(expected) == 2


# --- tables over frequency ------------------------------------------------------------------------------------------


def fixed_points(M, C, K, tables, top):
    """Real poles at rest and fixed points of Im lambda of dense matrices with tables (row, rows), by bisection."""

    n = len(M)

    def poles(omega):
        k, c = K, C
        for a, rows in tables:
            f, *columns = np.array(rows, dtype=float).T
            k, c = (
                total + np.interp(omega / (2 * np.pi), f, column)[..., None, None] * np.outer(a, a)
                for total, column in zip((k, c), columns, strict=True)
            )
        A = np.zeros((*np.shape(omega), 2 * n, 2 * n))
        A[..., :n, n:], A[..., n:, :n], A[..., n:, n:] = np.eye(n), -np.linalg.solve(M, k), -np.linalg.solve(M, c)
        return np.linalg.eigvals(A)

    def above(omega):
        return np.sum(poles(omega).imag > np.expand_dims(omega, -1), axis=-1)

    def between(low, high, most, least):
        if most <= least:  # a fixed point at which the number rises is no mode
            return []
        if high - low < 1e-13 * high:
            every = poles(high)
            return [every[np.argmin(np.abs(every.imag - high))]] * int(most - least)
        middle = (low + high) / 2
        count = above(middle)
        return [*between(low, middle, most, count), *between(middle, high, count, least)]

    grid = np.geomspace(1e-3, top, 1500)  # finer than what two fixed points could be apart here
    ends = pairwise(zip(grid, above(grid), strict=True))
    rest = poles(0.0)
    still = rest[np.abs(rest.imag) < 1e-9 * np.abs(rest)].real
    return [*still, *(z for (low, most), (high, least) in ends for z in between(low, high, most, least))]


def film(rows, ground=None):
    """A mass on a spring to ground, or to another mass, with a ring in a film of this table."""
    second = [] if ground else [tn.Inertia("B", node="b", inertia=3)]
    damper = tn.ViscousDamper("d", node="a", ring_inertia=1, table=rows)
    spring = tn.Spring("k", nodes=("a", ground or "b"), stiffness=400)
    return tn.Drivetrain("film", [tn.Inertia("J", node="a", inertia=1), spring, *second, damper])


class TestTables:
    def test_a_film_without_stiffness_has_the_poles_of_a_damper(self):
        """Roots of s ((s^2 + 400) (s + 20) + 20 s^2) = 0, a pole at 0 apart."""
        modes = film([[0.01, 0, 20], [1000, 0, 20]], ground="ground").modes()
        roots = np.roots([1, 40, 400, 8000])
        expected = [0, *roots[roots.imag >= 0]]
        np.testing.assert_allclose(np.sort_complex(modes.eigenvalues), np.sort_complex(expected), rtol=1e-12)
        assert modes.undamped_natural_frequencies == pytest.approx([0, 10 / np.pi], rel=1e-13)

    def test_a_film_whose_stiffness_falls_to_zero_at_rest(self):
        """k and c are read at |Im s|; the real pole is that of c = 20 without k."""
        modes = film([[0, 0, 20], [5, 2, 19], [50, 30, 15]]).modes()
        found = [value for value in modes.eigenvalues if value]
        assert found == pytest.approx([-2.28175 + 19.29522j, -35.54815], rel=1e-6)
        assert modes.kinds.count("rigid body") == 2

    @pytest.mark.parametrize("seed", range(12))
    def test_random_chains_have_the_fixed_points_of_dense_matrices(self, seed):
        """Tables of equal rows, that overdamp, and gentle ones, with as many poles as states."""
        chance = np.random.default_rng(seed)
        n, tables, elements = 4, [], []
        M, C, K = np.diag(10 ** chance.uniform(-1, 1, 4)), np.zeros((4, 4)), np.zeros((4, 4))
        for i in range(n):
            row = np.eye(n)[i] - (np.eye(n)[i + 1] if i + 1 < n else 0)
            nodes = (f"n{i}", f"n{i + 1}" if i + 1 < n else "ground")
            k = 10 ** chance.uniform(2, 4)
            c = k**0.5 * chance.choice([0.02, 0.1, 30.0])  # far from critical damping
            elements.append(tn.Inertia(f"J{i}", node=f"n{i}", inertia=M[i, i]))
            if i % 2:
                C, K = C + c * np.outer(row, row), K + k * np.outer(row, row)
                elements.append(tn.Spring(f"k{i}", nodes=nodes, stiffness=k, damping=c))
                continue
            change = 0.0 if seed % 3 == 0 else 0.3
            rows = [(f, k * (1 + change * part), c * (1 - change * part)) for part, f in enumerate((0.5, 3.0, 12.0))]
            tables.append((row, rows))
            elements.append(tn.TabulatedSpring(f"t{i}", nodes=nodes, table=rows))
        modes = tn.Drivetrain("chain", elements).modes()
        expected = fixed_points(M, C, K, tables, 1e4)
        assert sum(2 - (z.imag == 0) for z in modes.eigenvalues) == 2 * n
        np.testing.assert_allclose(np.sort_complex(modes.eigenvalues), np.sort_complex(expected), rtol=1e-7)

    @pytest.mark.parametrize("seed", [0, 2, 7, 12, 13, 20])
    def test_near_critical_damping_no_fixed_point_is_lost(self, seed):
        """Films soft at rest and steep tables: all real poles at rest, and all vibrations at their own frequency."""
        chance = np.random.default_rng(seed)
        tables, elements = [], []
        M, nothing = np.diag(10 ** chance.uniform(-1, 1, 4)), np.zeros((4, 4))
        for i in range(4):
            row = np.eye(4)[i] - (np.eye(4)[i + 1] if i < 3 else 0)
            nodes = (f"n{i}", f"n{i + 1}" if i < 3 else "ground")
            k = 10 ** chance.uniform(2, 4)
            c = 2 * 10 ** chance.uniform(-1, 0.7) * np.sqrt(k * M[i, i])
            soft = 0.0 if chance.uniform() < 0.25 else k * 10 ** chance.uniform(-1, 0.3)
            first = (0.5, soft, c * 10 ** chance.uniform(-0.5, 0.5))
            last = (12.0, k * 10 ** chance.uniform(-0.2, 0.5), c * 10 ** chance.uniform(-1, 0))
            rows = [first, (3.0, k, c), last]
            if chance.uniform() < 0.3:
                rows = [(f, k, c) for f, _, _ in rows]
            elements += [
                tn.Inertia(f"J{i}", node=f"n{i}", inertia=M[i, i]),
                tn.TabulatedSpring(f"t{i}", nodes=nodes, table=rows),
            ]
            tables.append((row, rows))
        modes = tn.Drivetrain("chain", elements).modes()
        expected = [z for z in fixed_points(M, nothing, nothing, tables, 1e4) if abs(z) > 1e-9]
        values = modes.eigenvalues[modes.eigenvalues != 0]
        np.testing.assert_allclose(np.sort_complex(values), np.sort_complex(expected), rtol=1e-7)
        more = sum(2 - (z.imag == 0) for z in modes.eigenvalues) - 8  # states: a rigid body counts once, as at rest
        assert any("so steep" in note for note in modes.notes) == (more > 0)

    def test_a_vibration_at_its_own_frequency_stands_beside_the_real_poles_at_rest(self):
        """0.001 s^2 + c s + k: two real roots with the first row, -500 +- 742j with the last, which the mode reads."""
        bush = tn.TabulatedSpring("bush", nodes=("a", "ground"), table=[[1, 400, 2], [20, 800, 1]])
        rig = tn.Drivetrain("bush", [tn.Inertia("J", node="a", inertia=0.001), bush], inputs={"T": {"torque": "a"}})
        modes = rig.modes()
        expected = [*np.roots([0.001, 1, 800])[:1], *np.roots([0.001, 2, 400])]
        np.testing.assert_allclose(np.sort_complex(modes.eigenvalues), np.sort_complex(expected), rtol=1e-12)
        text = "bush: the rows of its table go from 1 to 20 Hz, and it is read at up to"
        steep = "tables over frequency are so steep that there is 1 vibration more than with their values at rest"
        read = f"{text.replace('at up to', 'from 0 Hz, where the first row is kept, and at up to')} 118.032 Hz"
        assert modes.notes == (f"{read}, where the last row is kept", steep)
        assert rig.frequency_response("a", "T", [5, 163]).notes == (f"{text} 163 Hz, where the last row is kept",)
        assert rig.frequency_response("a", "T", [1, 20]).notes == ()

    def test_both_frequencies_that_a_steep_table_allows_are_modes(self):
        """sqrt(30) rad/s below 1 Hz and sqrt(60) rad/s above."""
        bush = tn.TabulatedSpring(
            "k", nodes=("a", "ground"), table=[[0.1, 30, 0], [1.0, 30, 0], [1.01, 60, 0], [9, 60, 0]]
        )
        modes = tn.Drivetrain("steep", [tn.Inertia("j", node="a", inertia=1), bush]).modes()
        assert modes.eigenvalues == pytest.approx([1j * 30**0.5, 1j * 60**0.5])
        assert "1 vibration more than with their values at rest" in modes.notes[0]

    def test_where_stiffness_rises_quicker_than_frequency_no_vibration_is_counted(self):
        """(omega^2)' = 2 omega below k', so that the frequency above overtakes: sqrt(30), 5.8 and sqrt(60) rad/s."""
        rows = [[0.1, 30, 0], [0.9, 30, 0], [1.1, 60, 0], [9, 60, 0]]
        bush = tn.TabulatedSpring("k", nodes=("a", "ground"), table=rows)
        system = tn.Drivetrain("steep", [tn.Inertia("j", node="a", inertia=1), bush]).assembly.system
        hertz = np.array([30**0.5 / (2 * np.pi), np.roots([(2 * np.pi) ** 2, -150, 105])[1], 60**0.5 / (2 * np.pi)])
        met = [Mode(2j * np.pi * f, np.ones(1)) for f in hertz]
        search = frozen_stiffness.FixedPoints(frozen_stiffness.FrozenProblem(system, undamped=True))
        assert search._where_the_count_falls(met) == met[::2]

    def test_the_lowest_with_several_rings_free_at_rest_are_found_by_sparse_methods(self, monkeypatch):
        """Three rigid motions at rest, more than modes sought beside them."""
        elements = [tn.Inertia("J0", node="n0", inertia=1)]
        for i in range(70):
            elements += [
                tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e4, damping=1),
                tn.Inertia(f"J{i + 1}", node=f"n{i + 1}", inertia=1),
            ]
        for node, k in (("n0", 2000), ("n50", 200)):
            rows = [[0, 0, 20], [5, k, 19], [50, 15 * k, 15]]
            elements.append(tn.ViscousDamper(f"at_{node}", node=node, ring_inertia=2, table=rows))
        chain = tn.Drivetrain("chain", elements)
        every = chain.modes()
        monkeypatch.setattr(frozen_stiffness, "modes", None)
        np.testing.assert_allclose(chain.modes(lowest=5).eigenvalues, every.eigenvalues[:5], rtol=1e-9, atol=1e-12)

    @pytest.mark.parametrize("kind", ["table", "hysteretic"])
    def test_the_lowest_of_many_modes_are_those_of_all(self, kind):
        law = {
            "table": tn.TabulatedSpring("t", nodes=("n70", "ground"), table=[[1, 100, 0.2], [60, 4e5, 9]]),
            "hysteretic": tn.HystereticSpring("t", nodes=("n70", "ground"), stiffness=1e4, loss_factor=0.1),
        }[kind]
        elements = [tn.Inertia("J0", node="n0", inertia=1), law]
        for i in range(70):
            elements += [
                tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e6, damping=5),
                tn.Inertia(f"J{i + 1}", node=f"n{i + 1}", inertia=1),
            ]
        chain = tn.Drivetrain("chain", elements)
        few, every = chain.modes(lowest=5), chain.modes()
        assert len(every) == 71
        np.testing.assert_allclose(few.eigenvalues, every.eigenvalues[:5], rtol=1e-9)
        np.testing.assert_allclose(
            few.undamped_natural_frequencies, every.undamped_natural_frequencies[:5], rtol=1e-9, atol=1e-12
        )


NOTHING_VIBRATES = {
    "real": [tn.Spring("t", nodes=("a", "ground"), stiffness=400, damping=80)],  # s^2 + 80 s + 400
    "rigid": [tn.Inertia("B", node="b", inertia=2), tn.Damper("t", nodes=("a", "b"), damping=3)],
    "nothing": [],
}


class TestWithoutVibrations:
    """Models of which no mode vibrates, by overdamping or for want of springs."""

    @staticmethod
    def model(kind):
        return tn.Drivetrain(
            kind,
            [tn.Inertia("J", node="a", inertia=1), *NOTHING_VIBRATES[kind]],
            inputs={"T": {"torque": "a"}},
            sensors={"th": {"angle": "a"}},
            speeds={"of": "a", "range": "600..1500 rpm", "step": "50 rpm"},
            excitations={"m": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "1 N*m"}}}},
        )

    @pytest.mark.parametrize("kind", NOTHING_VIBRATES)
    def test_no_sentence_speaks_of_a_lowest_vibration(self, kind, tmp_path):
        model = self.model(kind)
        none = "none of these is a vibration; rigid bodies and real poles have no number"
        assert none in model.modes().table().notes
        (counted, *others) = model.critical_speeds().mode_table().notes
        left = "damping leaves none of these a vibration; they are numbered as without damping"
        assert (counted, others) == (left if kind == "real" else none, [])
        (file, *_) = tn.write_report(model, tmp_path / "report.md", date=None)
        assert "lowest vibration" not in file.read_text(encoding="utf-8")

    def test_a_mode_that_is_asked_for_is_refused_with_the_reason(self):
        for ask in (lambda rig: rig.holzer_table(mode=1), lambda rig: rig.critical_speeds().mode(1)):
            with pytest.raises(UsageError, match="unknown-mode"):
                ask(self.model("rigid"))
