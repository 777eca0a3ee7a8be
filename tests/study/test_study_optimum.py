"""Designs for targets and under limits against closed forms: chains, dampers of Den Hartog and of Nishihara and Asami."""

import json

import mpmath
import numpy as np
import pytest

import torsionnet as tn
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective, DesignTarget
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.optimise import evolve, initial_places, optimise
from torsionnet.study.quantities.quantity import QuantityLimit

J_END = 0.5


def sought(name, start, lower=None, upper=None, unit=""):
    return DesignParameter(name, unit, start, start / 10 if lower is None else lower, upper or 10 * start, start)


def smallest(*names, sense="minimise", **limits):
    return DesignGoals(objectives=(DesignObjective(names, sense),), limits=limits)


def placed(**targets):
    return DesignGoals(targets=tuple(DesignTarget(name, value) for name, value in targets.items()))


def chain(values):
    """Natural frequencies in Hz of J_END - k - J - k - J_END by dense eigenvalues, of many at once."""
    k, middle = values["k"], values["J"]
    stiffness = k[:, None, None] * np.array([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]])
    root = np.stack([np.full_like(k, J_END), middle, np.full_like(k, J_END)], axis=1) ** -0.5
    squares = np.linalg.eigvalsh(root[:, :, None] * stiffness * root[:, None, :])
    return {"f1": np.sqrt(squares[:, 1]) / (2 * np.pi), "f2": np.sqrt(squares[:, 2]) / (2 * np.pi)}


def chain_for(f1, f2):
    """Closed form of the symmetric chain: omega_1^2 = k/J_END, omega_2^2 = k (1/J_END + 2/J)."""
    k = J_END * (2 * np.pi * f1) ** 2
    return k, 2 / ((2 * np.pi * f2) ** 2 / k - 1 / J_END)


CHAIN = (sought("k", 1e3, unit="N*m/rad"), sought("J", 1.0, unit="kg*m^2"))


class TestTargets:
    @pytest.mark.parametrize(("f1", "f2"), [(8.0, 25.0), (5.0, 9.0), (15.0, 20.0)])
    def test_two_frequencies_of_a_chain(self, f1, f2):
        found = optimise(DesignProblem(CHAIN, placed(f1=f1, f2=f2), chain), single=singly)
        k, middle = chain_for(f1, f2)
        assert found.values == {"k": pytest.approx(k, rel=1e-8), "J": pytest.approx(middle, rel=1e-8)}
        assert found.sentences[:2] == (f"f1 has its target, {f1:g}", f"f2 has its target, {f2:g}")
        assert "recomputed by a model with these values: the same" in found.sentences
        assert found.free_directions == 0
        assert not found.active_bounds

    def test_an_unsymmetric_chain_by_mpmath(self):
        """Both stiffnesses sought; the two solutions of the pair of equations are both known."""
        first, middle, last, f1, f2 = 0.4, 0.9, 0.7, 6.0, 14.0

        def frequencies(values):
            one, two = values["k_1"], values["k_2"]
            a = one * (1 / first + 1 / middle) + two * (1 / middle + 1 / last)
            b = one * two * (first + middle + last) / (first * middle * last)
            root = np.sqrt(a**2 - 4 * b)
            return {"f1": np.sqrt((a - root) / 2) / (2 * np.pi), "f2": np.sqrt((a + root) / 2) / (2 * np.pi)}

        mpmath.mp.dps = 30
        squares = [(2 * mpmath.pi * f) ** 2 for f in (f1, f2)]
        left, right = mpmath.mpf(1) / first + mpmath.mpf(1) / middle, mpmath.mpf(1) / middle + mpmath.mpf(1) / last
        product = squares[0] * squares[1] * first * middle * last / (mpmath.mpf(first) + middle + last)
        roots = mpmath.polyroots([left, -(squares[0] + squares[1]), right * product])
        known = sorted((float(one), float(product / one)) for one in roots)
        parameters = (sought("k_1", 1e3), sought("k_2", 1e3))
        found = optimise(DesignProblem(parameters, placed(f1=f1, f2=f2), frequencies))
        both = sorted([tuple(found.values.values()), *(tuple(one.values()) for one in found.alternatives)])
        assert both == [pytest.approx(one, rel=1e-8) for one in known]
        start = np.log([1e3, 1e3])
        nearest = min(known, key=lambda one: np.linalg.norm(np.log(one) - start))
        assert tuple(found.values.values()) == pytest.approx(nearest, rel=1e-8)
        assert any(text.startswith("not unique: equally good are k_1 = ") for text in found.sentences)

    def test_out_of_reach(self):
        found = optimise(DesignProblem((sought("k", 1e3, 1e3, 2e3),), placed(f=5.0), one_mass))
        assert found.values["k"] == pytest.approx(1e3)
        assert found.active_bounds == {"k": "lower"}
        assert "f comes to 7.11763: its target 5 is not reached within the bounds" in found.sentences
        assert "k is at its lower bound" in found.sentences

    def test_two_out_of_reach_are_not_said_to_leave_a_choice(self):
        """Frequencies farther apart than masses allow: the slopes cancel at the nearest pair, and there is but one."""

        def chain(values):
            one, two = values["k_1"], values["k_2"]
            a, b = 1.5 * one + 7 / 6 * two, 1.5 * one * two  # masses 1, 2, 1.5 kg*m^2
            root = np.sqrt(a**2 - 4 * b)
            return {"f1": np.sqrt((a - root) / 2) / (2 * np.pi), "f2": np.sqrt((a + root) / 2) / (2 * np.pi)}

        parameters = (sought("k_1", 1e3), sought("k_2", 2e3))
        found = optimise(DesignProblem(parameters, placed(f1=10.0, f2=10.5), chain))
        assert not found.active_bounds
        assert found.after["f1"][0] == pytest.approx(8.0334, rel=1e-3)
        assert found.free_directions == 0
        assert not any("not unique" in text for text in found.sentences)

    def test_more_targets_than_parameters(self):
        """Least squares of relative deviations of two multiples of one frequency: closed form."""
        goals = placed(f=10.0, twice=24.0)
        found = optimise(DesignProblem((sought("k", 1e3),), goals, one_mass))
        best = (1 / 10 + 2 / 24) / (1 / 10**2 + (2 / 24) ** 2)
        assert found.after["f"][0] == pytest.approx(best, rel=1e-8)
        assert "2 targets and 1 parameters: least squares of relative deviations" in found.sentences

    def test_more_parameters_than_targets(self):
        parameters = (sought("k", 1e3), sought("inertia", 0.5))
        found = optimise(DesignProblem(parameters, placed(f=10.0), one_mass))
        assert found.after["f"][0] == pytest.approx(10, rel=1e-9)
        assert found.free_directions == 1
        assert any(text.startswith("not unique: one combination of the parameters") for text in found.sentences)

    def test_a_target_within_limits(self):
        """k as large as its target wants is not allowed by the limit, which then holds."""
        goals = DesignGoals((DesignTarget("f", 20.0),), limits={"twice": QuantityLimit(below=30.0)})
        found = optimise(DesignProblem((sought("k", 1e3),), goals, one_mass))
        assert found.after["f"][0] == pytest.approx(15, rel=1e-7)
        assert "limits are kept; the optimum lies at the limit of twice" in found.sentences


def one_mass(values):
    f = np.sqrt(values["k"] / values.get("inertia", J_END)) / (2 * np.pi)
    return {"f": f, "twice": 2 * f}


def singly(values):
    rig = tn.Drivetrain(
        "chain",
        [
            *(tn.Inertia(node, node=node, inertia=J) for node, J in (("a", J_END), ("b", values["J"]), ("c", J_END))),
            tn.Spring("s", nodes=("a", "b"), stiffness=values["k"]),
            tn.Spring("t", nodes=("b", "c"), stiffness=values["k"]),
        ],
    )
    return dict(zip(("f1", "f2"), rig.modes().natural_frequencies[1:], strict=True))


def magnification(mu, g):
    """Of an undamped mass with an absorber of frequency ratio f and damping ratio z of its own (n, n_g)."""

    def curve(values):
        f, z = values["f"][:, None], values["z"][:, None]
        ring = f**2 - g**2 + 2j * z * f * g
        return {"H": np.abs(ring / ((1 + mu * f**2 - g**2 + 2j * mu * z * f * g) * ring - mu * (ring + g**2) ** 2))}

    return curve


class TestCurves:
    """The largest point of a curve made small, in which two peaks come to be equal."""

    @pytest.mark.few(1)
    @pytest.mark.parametrize("mu", [0.05, 0.2])
    def test_exact_minimax_of_the_tuned_damper(self, mu):
        """O. Nishihara and T. Asami, J. Vib. Acoust. 124 (2002) 576."""
        curve = magnification(mu, np.linspace(0.6, 1.3, 1401))
        parameters = sought("f", 1.0, 0.5, 2.0), sought("z", 0.1, 0.01, 1.0)
        found = optimise(DesignProblem(parameters, smallest("H"), curve))
        root = np.sqrt(4 + 3 * mu)
        square = 2 * (16 + 23 * mu + 9 * mu**2 + 2 * (2 + mu) * root) / (3 * (64 + 80 * mu + 27 * mu**2))
        assert found.values["f"] == pytest.approx(2 / (1 + mu) * np.sqrt(square), rel=2e-4)  # points are 5e-4 apart
        assert found.values["z"] == pytest.approx(np.sqrt((8 + 9 * mu - 4 * root) / (1 + mu)) / 4, rel=5e-3)
        fixed_points = np.sqrt(1 + 2 / mu)
        assert fixed_points * (1 - 1e-5) < found.merit < fixed_points * 1.005  # no tuning is below its fixed points

    @pytest.mark.parametrize("mu", [0.2, 1.0])
    def test_untuned_damper(self, mu):
        """J. P. Den Hartog: the peak is 1 + 2/mu, at c/(2 J_ring omega_1) = 1/sqrt(2 (1 + mu) (2 + mu))."""
        g = np.sqrt(2 / (2 + mu)) * np.geomspace(0.8, 1.25, 2001)  # the fixed point is one of them

        def curve(values):
            ring = -(g**2) + 2j * values["z"][:, None] * g
            film = 2j * mu * values["z"][:, None] * g
            return {"H": np.abs(ring / ((1 - g**2 + film) * ring - film * 2j * values["z"][:, None] * g))}

        found = optimise(DesignProblem((sought("z", 1.0, 0.01, 10),), smallest("H"), curve))
        assert found.merit == pytest.approx(1 + 2 / mu, rel=1e-6)
        assert found.values["z"] == pytest.approx(1 / np.sqrt(2 * (1 + mu) * (2 + mu)), rel=2e-3)


def area(values):
    x, y = values["x"], values["y"]
    return {"sum": x + y, "product": x * y, "bump": -np.exp(-((np.log(x) - 1) ** 2) - (np.log(y) + 0.5) ** 2)}


SIDES = (sought("x", 3.0, 0.1, 10.0), sought("y", 0.2, 0.1, 10.0))


class TestObjectives:
    def test_smallest_within_a_limit(self):
        goals = smallest("sum", product=QuantityLimit(above=1.0))
        found = optimise(DesignProblem(SIDES, goals, area))
        assert found.values == {"x": pytest.approx(1, abs=1e-5), "y": pytest.approx(1, abs=1e-5)}
        assert found.merit == pytest.approx(2, rel=1e-8)
        assert "limits are kept; the optimum lies at the limit of product" in found.sentences

    def test_largest_within_a_limit(self):
        found = optimise(
            DesignProblem(SIDES, smallest("product", sense="maximise", sum=QuantityLimit(below=6.0)), area)
        )
        assert found.merit == pytest.approx(9, rel=1e-8)
        assert "product goes from 0.6 to 9 (maximised)" in found.sentences

    def test_inside(self):
        found = optimise(DesignProblem(SIDES, smallest("bump"), area))
        assert np.log(list(found.values.values())) == pytest.approx([1, -0.5], abs=1e-6)
        assert found.converged

    def test_worst_of_two(self):
        """sum and 4/product: x = y by symmetry, 2 x = 4/x^2."""
        worst = {"sum": lambda v: area(v)["sum"], "other": lambda v: 4 / area(v)["product"]}
        problem = DesignProblem(
            SIDES, smallest("sum", "other"), lambda v: {name: function(v) for name, function in worst.items()}
        )
        found = optimise(problem)
        assert found.values["x"] == pytest.approx(2 ** (1 / 3), rel=1e-5)
        assert found.merit == pytest.approx(2 * 2 ** (1 / 3), rel=1e-7)

    def test_among_many_valleys(self):
        """The deepest valley of a wavy floor, of which every tenth of the range is one."""

        def wavy(values):
            x = np.stack([values["x"], values["y"]])
            return {"z": np.sum(x**2 - 10 * np.cos(2 * np.pi * x), axis=0)}

        parameters = sought("x", 4.0, -4.7, 5.1), sought("y", -3.0, -4.1, 5.3)
        found = optimise(DesignProblem(parameters, smallest("z"), wavy))
        assert found.merit == pytest.approx(-20, abs=1e-9)
        assert list(found.values.values()) == pytest.approx([0, 0], abs=1e-7)
        assert found.converged  # although searches from elsewhere end in other valleys
        assert not any("settle" in said for said in found.sentences)

    def test_limits_nobody_keeps(self):
        found = optimise(DesignProblem(SIDES, smallest("sum", product=QuantityLimit(above=200.0)), area))
        assert found.values == {"x": pytest.approx(10), "y": pytest.approx(10)}
        assert found.violation == pytest.approx(0.5)
        said = "no design within the bounds was found that keeps all limits; this one exceeds product"
        assert said in found.sentences

    def test_designs_without_a_value_are_avoided(self):
        """Nearer and nearer to where values begin."""

        def partly(values):
            return {"z": np.where(values["x"] > 1, values["x"], np.nan)}

        found = optimise(DesignProblem((sought("x", 0.5, 0.1, 10),), smallest("z"), partly))
        assert found.merit == pytest.approx(1, rel=2e-6)
        assert found.converged

    @pytest.mark.slow
    def test_a_search_that_ends_too_early_says_so(self, monkeypatch):
        """Along the bottom of a bent gorge every step is short, and each finds a better design."""

        def gorge(values):
            x, y = np.log10(values["x"]), np.log10(values["y"])
            return {"z": 1 + 3 * np.abs(y - x**2) + (1 - x) ** 2}

        problem = DesignProblem((sought("x", 0.05, 0.01, 100), sought("y", 10, 0.01, 100)), smallest("z"), gorge)
        assert optimise(problem).converged
        monkeypatch.setattr("torsionnet.study.design.optimise.MOST_ROUNDS", 1)
        stopped = optimise(problem, generations=1)
        assert not stopped.converged
        assert stopped.sentences[-1] == "the search did not settle: designs beside this one go on being better"

    def test_the_same_seed_gives_the_same_answer(self):
        one, two = (optimise(DesignProblem(SIDES, smallest("bump"), area), seed=3) for _ in range(2))
        assert one.values == two.values
        np.testing.assert_array_equal(one.history, two.history)

    @pytest.mark.parametrize("above", [1.0, 200.0])
    def test_evolution_goes_to_designs_that_keep_limits_or_come_nearest(self, above):
        """The smallest sum keeps no limit; of x y above 200, which is at most 100, the largest product lacks least."""
        problem = DesignProblem(SIDES, smallest("sum", product=QuantityLimit(above=above)), area)
        place = evolve(problem, initial_places(problem), 0, lambda _: None, 30)
        ((violation, _),) = problem.ranks(problem.at(place))
        assert violation == pytest.approx(max(0.0, 1 - 100 / above), abs=0.01)


class TestSlopes:
    def test_numerical_ones(self):
        """Against the derivatives of the closed form, inside and at bounds."""
        problem = DesignProblem(SIDES, smallest("sum", product=QuantityLimit(below=1.0)), area)
        for place in ([0.3, 0.6], [0.0, 1.0], [1e-4, 0.9995]):
            values = np.array(list(problem.values(np.array(place)).values()))
            moved = problem.jacobian(np.array(place))
            rates = values * np.log(100)
            np.testing.assert_allclose(moved["sum"], [rates], rtol=1e-9)
            np.testing.assert_allclose(moved["product"], [values[::-1] * rates], rtol=1e-9)

    def test_exact_ones_are_used(self):
        asked = []

        def slopes(values):
            asked.append(values)
            f = one_mass({name: np.array([value]) for name, value in values.items()})["f"]
            return {"f": np.array([[f[0] / (2 * values["k"])]])}

        problem = DesignProblem((sought("k", 1e3),), placed(f=12.0), one_mass, slopes)
        found = optimise(problem)
        assert found.after["f"][0] == pytest.approx(12, rel=1e-9)
        assert asked
        numerical = DesignProblem((sought("k", 1e3),), placed(f=12.0), one_mass)
        optimise(numerical)
        assert problem.evaluations < numerical.evaluations / 2

    def test_those_that_are_not_all_known_are_numerical(self):
        def slopes(values):
            return {"sum": np.array([[1.0, np.nan]]), "product": np.array([[values["y"], values["x"]]])}

        problem = DesignProblem(SIDES, smallest("sum", product=QuantityLimit(below=1.0)), area, slopes)
        place = np.array([0.3, 0.6])
        moved, values = problem.jacobian(place), np.array(list(problem.values(place).values()))
        np.testing.assert_allclose(moved["sum"], [values * np.log(100)], rtol=1e-9)
        np.testing.assert_allclose(moved["product"], [values[::-1] * values * np.log(100)], rtol=1e-12)


class TestRefusals:
    @pytest.mark.parametrize(
        ("goals", "words"),
        [
            (lambda: placed(sums=1.0), r'(?s)did you mean "sum".*unknown-name'),
            (lambda: placed(sum=np.nan), "out-of-range"),
            (DesignGoals, "say what is sought"),
            (lambda: DesignGoals(limits={"sum": QuantityLimit(below=1.0)}), "missing-entry"),
            (
                lambda: DesignGoals((DesignTarget("sum", 1.0),), (DesignObjective(("sum",)),)),
                "contradicting-entries",
            ),
        ],
    )
    def test_goals(self, goals, words):
        with pytest.raises(tn.UsageError, match=words):
            optimise(DesignProblem(SIDES, goals(), area))

    @pytest.mark.parametrize("bounds", [(2.0, 1.0), (1.0, 1.0), (0.0, np.inf)])
    def test_bounds(self, bounds):
        with pytest.raises(tn.UsageError, match="unordered-rows"):
            DesignProblem((DesignParameter("x", "", 1.0, *bounds, 1.0),), smallest("sum"), area)

    def test_no_parameters(self):
        with pytest.raises(tn.UsageError, match="which parameters may change"):
            DesignProblem((), smallest("sum"), area)

    def test_nothing_to_calculate(self):
        problem = DesignProblem(SIDES, smallest("z"), lambda v: {"z": np.full(len(v["x"]), np.nan)})
        with pytest.raises(tn.SolveError, match="no-solution"):
            optimise(problem)


def test_a_model_that_says_something_else_is_reported():
    found = optimise(DesignProblem(CHAIN, placed(f1=8.0, f2=25.0), chain), single=lambda _: {"f1": 8.08, "f2": 25.0})
    assert "recomputed by a model with these values: different by 0.0099 of themselves" in found.sentences


def test_table_and_data():
    found = optimise(DesignProblem(CHAIN, placed(f1=8.0, f2=25.0), chain))
    assert [row[0] for row in found.table().rows] == ["k", "J", "f1", "f2"]
    assert [row[-1] for row in found.table().rows] == [None, None, 8.0, 25.0]
    assert json.loads(json.dumps(found.to_data()))["values"] == found.values
