"""Fronts of compromises against known ones: parabolas, a line through a sphere, ZDT1."""

import json
import sys

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.study.design.design_goals import DesignGoals, DesignObjective
from torsionnet.study.design.design_problem import DesignProblem
from torsionnet.study.design.pareto import pareto_front
from torsionnet.study.quantities.quantity import QuantityLimit


def parameters(count, low=-1.0, high=4.0, start=3.5):
    return tuple(DesignParameter(f"x{i}", "", start, low, high, start) for i in range(count))


def several(*names, sense="minimise", limits=None):
    return DesignGoals(objectives=tuple(DesignObjective((name,), sense) for name in names), limits=limits or {})


def parabolas(values):
    """J. D. Schaffer's x^2 and (x - 2)^2: the front is sqrt(a) + sqrt(b) = 2."""
    x = values["x0"]
    return {"a": x**2, "b": (x - 2) ** 2, "less a": -(x**2), "less b": -((x - 2) ** 2)}


def zdt1(values):
    """E. Zitzler, K. Deb and L. Thiele (2000): the front is b = 1 - sqrt(a)."""
    x = np.stack(list(values.values()), axis=1)
    g = 1 + 9 * x[:, 1:].mean(axis=1)
    return {"a": x[:, 0], "b": g * (1 - np.sqrt(x[:, 0] / g))}


def none_is_better(sizes):
    return not any((np.all(other <= one) and np.any(other < one)) for one in sizes for other in sizes)


@pytest.mark.slow
def test_two_parabolas():
    found = pareto_front(
        DesignProblem(parameters(1), several("a", "b"), parabolas), population=40, generations=40, single=parabolas
    )
    np.testing.assert_allclose(np.sqrt(found.values).sum(axis=1), 2, atol=1e-6)
    assert (found.designs.min(), found.designs.max()) == pytest.approx((0, 2), abs=1e-6)
    assert np.diff(np.sort(found.designs[:, 0])).max() < 0.2
    assert found.designs[found.compromise, 0] == pytest.approx(1, abs=0.05)
    assert found.values[found.extremes[1], 1] == pytest.approx(0, abs=1e-3)
    assert found.given.tolist() == [3.5**2, 1.5**2]
    assert found.sentences[-1] == "recomputed singly: the same"
    assert json.loads(json.dumps(found.to_data()))["values"] == found.values.tolist()


def test_what_is_maximised_is_shown_as_it_is():
    goals = several("less a", "less b", sense="maximise")
    found = pareto_front(DesignProblem(parameters(1), goals, parabolas), population=20, generations=20)
    assert (found.values <= 0).all()
    np.testing.assert_allclose(np.sqrt(-found.values).sum(axis=1), 2, atol=1e-6)


@pytest.mark.slow
def test_zdt1():
    problem = DesignProblem(parameters(5, 0, 1, 0.5), several("a", "b"), zdt1)
    found = pareto_front(problem, population=60, generations=150, seed=1)
    assert np.abs(found.values[:, 1] - 1 + np.sqrt(found.values[:, 0])).max() < 0.02
    assert none_is_better(found.values)
    assert found.values[:, 0].min() < 0.01
    assert found.values[:, 0].max() > 0.98
    assert found.evaluations > 60 * 150


def test_limits_cut_a_front():
    """With b below 1, x is above 1 on the front; the limit of b then holds at its end."""
    goals = several("a", "b", limits={"b": QuantityLimit(below=1.0)})
    found = pareto_front(DesignProblem(parameters(1), goals, parabolas), population=40, generations=40)
    assert found.designs.min() == pytest.approx(1, abs=0.01)
    assert found.values[:, 1].max() <= 1 + 1e-8


@pytest.mark.slow
def test_three_objectives():
    """Distances from three corners of a right triangle: the front is the triangle itself."""
    corners = {"o": (0, 0), "p": (1, 0), "q": (0, 1)}

    def distances(values):
        place = np.stack([values["x0"], values["x1"]])
        return {name: np.sum((place - np.array(one)[:, None]) ** 2, axis=0) for name, one in corners.items()}

    found = pareto_front(
        DesignProblem(parameters(2), several(*corners), distances), population=60, generations=80, seed=2
    )
    assert found.method == "NSGA-III"
    outside = np.maximum(-found.designs.min(axis=1), found.designs.sum(axis=1) - 1).clip(0)
    assert outside.mean() < 0.05  # hardly any of so few points is better in everything than one just outside
    assert np.median(outside) < 0.01
    assert np.linalg.norm(found.designs[list(found.extremes)] - list(corners.values()), axis=1).max() < 1e-5


@pytest.mark.slow
def test_the_seed_decides():
    problems = [DesignProblem(parameters(5, 0, 1, 0.5), several("a", "b"), zdt1) for _ in range(3)]
    one, same, other = (
        pareto_front(problem, population=20, generations=10, seed=seed)
        for problem, seed in zip(problems, (4, 4, 5), strict=True)
    )
    np.testing.assert_array_equal(one.designs, same.designs)
    assert not np.array_equal(one.designs[0], other.designs[0])


@pytest.mark.slow
def test_one_design_is_the_best_in_everything():
    def agreeing(values):
        return {"a": values["x0"] ** 2, "b": values["x0"] ** 2 + 1}

    found = pareto_front(DesignProblem(parameters(1, 0.0), several("a", "b"), agreeing), population=20, generations=40)
    assert found.designs.max() < 1e-3
    if len(found.designs) == 1:
        assert any("do not contradict each other" in text for text in found.sentences)


class TestRefusals:
    def test_one_objective(self):
        with pytest.raises(tn.UsageError, match="missing-entry"):
            pareto_front(DesignProblem(parameters(1), several("a"), parabolas))

    def test_unknown_quantity(self):
        with pytest.raises(tn.UsageError, match="unknown-name"):
            pareto_front(DesignProblem(parameters(1), several("a", "c"), parabolas))

    def test_settings(self):
        with pytest.raises(tn.UsageError, match="out-of-range"):
            pareto_front(DesignProblem(parameters(1), several("a", "b"), parabolas), population=2)

    @pytest.mark.slow
    def test_limits_nobody_keeps(self):
        goals = several("a", "b", limits={"a": QuantityLimit(below=-1.0)})
        with pytest.raises(tn.SolveError, match="no-solution"):
            pareto_front(DesignProblem(parameters(1), goals, parabolas), population=8, generations=3)

    def test_without_pymoo(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "pymoo.optimize", None)
        with pytest.raises(tn.MissingExtraError, match=r'pip install "torsionnet\[pareto\]"'):
            pareto_front(DesignProblem(parameters(1), several("a", "b"), parabolas))
