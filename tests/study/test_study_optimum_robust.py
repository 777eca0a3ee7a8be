"""Designs under tolerances against integrals in closed form."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective, DesignTarget
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.robust_optimum import SpaceTolerances, robust_optimum
from torsionnet.study.design.robust_problem import (
    MeanAndDeviation,
    Rejects,
    SamplePercentile,
    even_shares,
    random_shares,
)
from torsionnet.study.quantities.quantity import QuantityLimit
from torsionnet.study.space.correlation import Correlation
from torsionnet.study.space.space import Space
from torsionnet.study.space.variations.normal import Normal
from torsionnet.study.space.variations.uniform import ListOfValues, Uniform

SIGMA = 0.1
X = (DesignParameter("x", "", 2.0, 0.5, 4.0, 2.0),)
WELLS = ((1.0, 1.0, 0.05), (0.8, 3.0, 0.5))
"""Depth, place, width: the deeper one is narrow."""


@dataclass(frozen=True)
class Scatter:
    """One parameter around its design, or around zero: normal with a standard deviation, or uniform with half a width."""

    name: str
    size: float
    law: str = "normal"
    shares: np.ndarray | None = None

    def even_draws(self, count, seed):
        return replace(self, shares=even_shares(1, count, seed)[:, 0])

    def random_draws(self, count, seed):
        return replace(self, shares=random_shares(1, count, seed)[:, 0])

    @property
    def count(self):
        return len(self.shares)

    def around(self, designs):
        units = scipy.special.ndtri(self.shares) if self.law == "normal" else 2 * self.shares - 1
        found = {name: np.repeat(values, self.count) for name, values in designs.items()}
        size = len(next(iter(designs.values())))
        return {**found, self.name: found.get(self.name, 0.0) + np.tile(self.size * units, size)}


SCATTER = Scatter("x", SIGMA)


def least(**limits):
    return DesignGoals(objectives=(DesignObjective(("f",)),), limits=limits)


def wells(values):
    return {"f": -sum(depth * np.exp(-(((values["x"] - at) / width) ** 2)) for depth, at, width in WELLS)}


def moment(x, power):
    """Mean of f^power under a normal scatter, by quadrature with many points."""
    units, weights = np.polynomial.hermite_e.hermegauss(200)
    return float(weights @ wells({"x": x + SIGMA * units})["f"] ** power / np.sqrt(2 * np.pi))


def mean_and_deviation(x, k):
    mean = moment(x, 1)
    return mean + k * np.sqrt(moment(x, 2) - mean**2)


@pytest.mark.parametrize("k", [0.0, 1.0, 3.0])
def test_the_wide_well_is_the_robust_one(k):
    found = robust_optimum(DesignProblem(X, least(), wells), SCATTER, MeanAndDeviation(k), samples=1024)
    assert found.nominal.values["x"] == pytest.approx(1, abs=1e-3)
    best = scipy.optimize.minimize_scalar(lambda x: mean_and_deviation(x, k), bounds=(2.5, 3.5), method="bounded")
    assert found.values["x"] == pytest.approx(best.x, abs=0.01)
    _, nominal, robust = found.designs
    (name,) = found.robust.after
    assert name == ("mean of f" if k == 0 else f"mean + {k:g} sigma of f")
    assert robust.measures[name] == pytest.approx(best.fun, rel=0.01)
    assert robust.mean["f"] == pytest.approx(moment(best.x, 1), rel=0.01)
    assert nominal.measures[name] == pytest.approx(mean_and_deviation(1.0, k), rel=0.05, abs=0.02)
    assert robust.measures[name] < nominal.measures[name]


def square(values):
    return {"f": values["x"] ** 2}


def test_a_percentile_holds_a_limit():
    """97.5 % above 1: x = 1 + 1.95996 sigma."""
    problem = DesignProblem(X, least(f=QuantityLimit(above=1.0)), square)
    found = robust_optimum(problem, SCATTER, SamplePercentile(97.5), samples=4096)
    assert found.nominal.values["x"] == pytest.approx(1, rel=1e-6)
    assert found.values["x"] == pytest.approx(1 + SIGMA * scipy.stats.norm.ppf(0.975), abs=1e-3)
    given, nominal, robust = found.designs
    assert given.share_kept[0] == 1
    for design, share in ((nominal, 0.5), (robust, 0.975)):
        low, high = design.share_kept[1:]
        assert low < share < high


@pytest.mark.slow
def test_fewest_rejects():
    """Between 1 and 2 in the square: the middle of 1 and sqrt(2) is best."""
    goals = DesignGoals(limits={"f": QuantityLimit(above=1.0, below=2.0)})
    found = robust_optimum(DesignProblem(X, goals, square), SCATTER, Rejects(), samples=512)
    middle, half = (1 + np.sqrt(2)) / 2, (np.sqrt(2) - 1) / 2
    assert found.values["x"] == pytest.approx(middle, abs=0.02)
    share, low, high = found.designs[-1].share_kept
    assert low < scipy.stats.norm.cdf(half / SIGMA) - scipy.stats.norm.cdf(-half / SIGMA) < high
    assert [one.label for one in found.designs] == ["as given", "robust"]
    assert any(text.startswith(f"robust: {100 * share:.4g} % keep all limits") for text in found.sentences)


def test_targets_are_met_in_the_mean_square():
    """(x^2/4 - 1)^2 under x = m + sigma u: mean m^4 + 6 m^2 s^2 + 3 s^4 - 8 (m^2 + s^2) + 16, over 16."""
    goals = DesignGoals((DesignTarget("f", 4.0),))
    found = robust_optimum(DesignProblem(X, goals, square), SCATTER, MeanAndDeviation(3.0), samples=2048)
    best = scipy.optimize.brentq(lambda m: 4 * m**3 + 12 * m * SIGMA**2 - 16 * m, 1, 3)
    assert found.values["x"] == pytest.approx(best, abs=2e-4)
    assert found.nominal.values["x"] == pytest.approx(2, rel=1e-9)


def test_what_is_not_designed_scatters_too():
    """f = (x - 1)^2 + x b with b uniform around 0: its deviation grows with x."""
    tolerance = Scatter("b", 0.6, "uniform")

    def leaning(values):
        return {"f": (values["x"] - 1) ** 2 + values["x"] * values.get("b", 0.0)}

    found = robust_optimum(DesignProblem(X, least(), leaning), tolerance, MeanAndDeviation(1.0), samples=4096)
    assert found.values["x"] == pytest.approx(1 - 0.6 / np.sqrt(3) / 2, abs=1e-3)
    assert found.nominal.values["x"] == pytest.approx(1, abs=1e-6)


def test_larger_is_better():
    """The highest of -f in the bad direction is mean - k sigma."""
    goals = DesignGoals(objectives=(DesignObjective(("g",), "maximise"),))
    problem = DesignProblem(X, goals, lambda values: {"g": -wells(values)["f"]})
    found = robust_optimum(problem, SCATTER, MeanAndDeviation(1.0), samples=512)
    (name,) = found.robust.after
    assert name == "mean - 1 sigma of g"
    assert found.designs[-1].measures[name] == pytest.approx(
        -scipy.optimize.minimize_scalar(lambda x: mean_and_deviation(x, 1.0), bounds=(2.5, 3.5), method="bounded").fun,
        rel=0.01,
    )


def test_draws():
    even, random = SCATTER.even_draws(1000, 3), SCATTER.random_draws(1000, 3)
    assert (even.count, random.count) == (1024, 1000)
    for drawn in (even, random):
        values = drawn.around({"x": np.array([2.0, 3.0])})["x"].reshape(2, -1)
        np.testing.assert_allclose(values[1] - values[0], 1)
        assert values[0].std() == pytest.approx(SIGMA, rel=0.06)
    np.testing.assert_array_equal(even.shares, SCATTER.even_draws(1000, 3).shares)
    assert not np.array_equal(even.shares, SCATTER.even_draws(1000, 4).shares)


class TestSpaceTolerances:
    """Distributions of a study around designs."""

    @pytest.fixture
    def space(self):
        rig = tn.load("dmf_rig")
        vary = {
            "k_2": Normal(deviation="5 %"),
            "c_2": Uniform(low="-10 %", high="+20 %"),
        }
        return Space(rig, vary, [Correlation(between=["k_2", "c_2"], coefficient=0.8)])

    def test_in_proportion_and_correlated(self, space):
        drawn = SpaceTolerances(space, ("k_2",)).random_draws(20_000, 1)
        values = drawn.around({"k_2": np.array([460.0, 920.0])})
        stiffness, damping = (values[name].reshape(2, -1) for name in ("k_2", "c_2"))
        np.testing.assert_allclose(stiffness[1], 2 * stiffness[0])
        np.testing.assert_array_equal(damping[1], damping[0])
        assert stiffness[0].mean() == pytest.approx(460, rel=2e-3)
        assert stiffness[0].std() == pytest.approx(23, rel=0.02)
        assert (damping.min(), damping.max()) == (pytest.approx(3.6, rel=1e-3), pytest.approx(4.8, rel=1e-3))
        assert np.corrcoef(stiffness[0], damping[0])[0, 1] == pytest.approx(0.8, abs=0.03)

    def test_refusals(self):
        with pytest.raises(tn.UsageError, match="a distribution under vary"):
            SpaceTolerances(Space(tn.load("dmf_rig"), {"k_2": ListOfValues(values=[1.0])}), ("k_2",))


def test_the_same_seed_gives_the_same_answer():
    one, two = (
        robust_optimum(DesignProblem(X, least(), wells), SCATTER, SamplePercentile(90.0), samples=64, seed=5)
        for _ in range(2)
    )
    assert json.dumps(one.to_data()) == json.dumps(two.to_data())
    assert one.table().to_text() == two.table().to_text()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda: MeanAndDeviation(-1.0), "a k from 0"),
        (lambda: SamplePercentile(100.0), r"(?s)100.*out-of-range"),
        (lambda: SCATTER.even_draws(1, 0), "two samples or more"),
        (
            lambda: robust_optimum(DesignProblem(X, least(), wells), SCATTER, Rejects()),
            "missing-entry",
        ),
        (
            lambda: robust_optimum(
                DesignProblem(X, DesignGoals(objectives=(DesignObjective(("f",)), DesignObjective(("g",)))), wells),
                SCATTER,
                SamplePercentile(),
            ),
            "contradicting-entries",
        ),
    ],
)
def test_refusals(change, words):
    with pytest.raises(tn.UsageError, match=words):
        change()
