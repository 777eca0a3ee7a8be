"""Answers of studies against closed forms: a mass on a spring, whose frequency with both lognormal is lognormal too."""

import json

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.study import define, run_study

DEVIATION = 0.05
J, K = 0.2, 8000.0
F = np.sqrt(K / J) / (2 * np.pi)
SPREAD = np.sqrt(np.log1p(DEVIATION**2))
"""Standard deviation of ln J and of ln k; that of ln f is this over sqrt(2)."""


def oscillator():
    return tn.Drivetrain(
        "oscillator",
        elements=[
            tn.Inertia("disc", node="a", inertia="J"),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness="k"),
            tn.Damper("oil", nodes=("a", "ground"), damping="c"),
        ],
        parameters={"J": J, "k": K, "c": 0.4},
        inputs={"T": {"torque": "a"}},
        sensors={"theta": {"angle": "a"}},
        configurations={"soft": {"k": K / 4}, "stiff": {"k": K}},
    )


LOGNORMAL = {"type": "lognormal", "deviation": "5 %"}
UNDAMPED = {"type": "natural_frequency", "mode": 1, "which": "undamped"}


def study(vary=None, quantities=None, **more):
    more.setdefault("sampling", {"count": 4000, "method": "random", "seed": 3})
    vary = vary or {"J": LOGNORMAL, "k": LOGNORMAL}
    return define(oscillator(), vary, quantities or {"f": UNDAMPED}, **more)


def answered(one, name="a"):
    answer = one.answers[name]
    return answer.conclude(one, run_study(one) if answer.of_variants else None)


def median():
    """Of the lognormal frequency: the means of J and k are given, their medians are smaller alike."""
    return F


def at_quantile(beta):
    return median() * np.exp(beta * SPREAD / np.sqrt(2))


class TestYield:
    def test_shares_and_their_intervals(self):
        limit = at_quantile(1.5)
        found = answered(study(limits={"f": {"below": limit}}, answers={"a": {"type": "yield"}}))
        share = found.of("as given")
        assert share.low < scipy.stats.norm.sf(1.5) < share.high
        assert share.count == 4000
        assert found.sentences[0].startswith(f"{100 * share.value:.1f} % (")
        assert found.sentences[0].endswith(f"f above {limit:g} Hz, as given")

    def test_a_variant_counts_once_for_all_configurations(self):
        """Stiff and soft have the same relative draws, so that just those with a stiff frequency too high are beyond."""
        one = study(
            {"J": LOGNORMAL, "k": LOGNORMAL}, configurations=["soft", "stiff"], limits={"f": {"below": at_quantile(1), "above": 1.0}},
            answers={"a": {"type": "yield", "weights": {"soft": 1, "stiff": 3}}},
        )  # fmt: skip
        found = answered(one)
        stiff = found.of("stiff")
        assert stiff.low < scipy.stats.norm.sf(1) < stiff.high
        assert found.of("soft").value == 0
        assert found.of("in any of them").value == stiff.value
        assert found.of("weighted mean").value == pytest.approx(0.75 * stiff.value)

    def test_points_of_a_grid_are_no_draws(self):
        vary = {"J": LOGNORMAL, "k": {"type": "list", "values": [K, 4 * K]}}
        found = answered(study(vary, limits={"f": {"below": 1.5 * F}}, answers={"a": {"type": "yield"}}))
        assert found.of("as given").value == pytest.approx(0.5)
        assert found.of("as given").count == 4000

    def test_a_grid_alone_is_known_without_an_interval(self):
        vary = {"k": {"type": "list", "values": [K, 2 * K, 4 * K, 8 * K]}}
        one = study(vary, limits={"f": {"below": 1.1 * F}}, answers={"a": {"type": "yield"}}, sampling=None)
        found = answered(one)
        assert found.of("as given").value == 0.75
        assert found.sentences[0].startswith("75 % of all variants")


def test_sobol_indices_of_independent_factors():
    """ln f is a sum with equal shares of the variance; f itself is nearly linear in it."""
    found = answered(study(answers={"a": {"type": "sobol_indices", "count": 2048}}))
    one = found.indices["as given", "f"]
    for values in (one.first, one.total):
        assert values == pytest.approx([0.5, 0.5], abs=0.02)
    assert one.variance == pytest.approx((F * SPREAD) ** 2 / 2, rel=0.02)
    assert one.evaluations == 2048 * 4


def test_sobol_indices_refuse_correlation():
    with pytest.raises(ModelError, match=r"answers\.a: .*contradicting-entries"):
        study(correlation=[{"between": ["J", "k"], "coefficient": 0.5}], answers={"a": {"type": "sobol_indices"}})


class TestFailureProbability:
    @pytest.mark.slow
    @pytest.mark.parametrize(("method", "count", "accuracy"), [("importance", 100_000, 0.05), ("subset", 200, 0.7)])
    def test_one_in_a_million(self, method, count, accuracy):
        beta = -scipy.stats.norm.ppf(1e-6)
        answer = {"type": "failure_probability", "method": method, "count": count}
        found = answered(study(limits={"f": {"below": at_quantile(beta)}}, answers={"a": answer}))
        one = found.events["as given"]
        assert one.probability == pytest.approx(1e-6, rel=accuracy)
        assert one.low < 1e-6 < one.high
        assert one.evaluations <= 100_000

    @pytest.mark.slow
    def test_both_sides_of_a_limit(self):
        answer = {"type": "failure_probability", "count": 50_000}
        limits = {"f": {"below": at_quantile(4), "above": at_quantile(-4)}}
        one = answered(study(limits=limits, answers={"a": answer})).events["as given"]
        assert one.probability == pytest.approx(2 * scipy.stats.norm.sf(4), rel=0.05)
        assert not one.doubts

    @pytest.mark.slow
    def test_correlated_parameters(self):
        """J and k with ln J and ln k correlated: the variance of ln f is less by what they have in common."""
        coefficient = 0.6
        answer = {"type": "failure_probability", "count": 50_000}
        one = study(
            limits={"f": {"below": at_quantile(3)}}, answers={"a": answer},
            correlation=[{"between": ["J", "k"], "coefficient": coefficient}],
        )  # fmt: skip
        of_logarithms = np.log1p(coefficient * DEVIATION**2) / SPREAD**2
        expected = scipy.stats.norm.sf(3 / np.sqrt(1 - of_logarithms))
        assert answered(one).events["as given"].probability == pytest.approx(expected, rel=0.05)


@pytest.mark.slow
def test_worst_case_is_in_the_corners():
    vary = {name: {"type": "uniform", "low": "-10 %", "high": "+10 %"} for name in ("J", "k")}
    found = answered(study(vary, answers={"a": {"type": "worst_case", "quantity": "f", "tried": 2000}}))
    largest, smallest = found.variants
    assert largest.value == pytest.approx(F * np.sqrt(1.1 / 0.9), rel=1e-9)
    assert (largest.at_lower, largest.at_upper) == (("J",), ("k",))
    assert smallest.value == pytest.approx(F * np.sqrt(0.9 / 1.1), rel=1e-9)
    assert largest.nominal == pytest.approx(F, rel=1e-9)
    assert largest.singly == pytest.approx(largest.value, rel=1e-9)
    assert largest.confirmed
    assert "J at the lower bound, k at the upper bound" in found.sentences[0]


@pytest.mark.slow
def test_a_worst_case_says_that_it_leaves_correlation_out():
    """J and k that rise together hardly move the frequency: its corners are no variants that are drawn."""
    vary = {name: {"type": "uniform", "low": "-10 %", "high": "+10 %"} for name in ("J", "k")}
    together = [{"between": ["J", "k"], "coefficient": 0.95}]
    answers = {"a": {"type": "worst_case", "quantity": "f", "tried": 10, "direction": "largest"}}
    found = answered(study(vary, answers=answers, correlation=together))
    assert found.sentences[-1].startswith("correlation is left out (J and k)")
    assert not any("correlation" in text for text in answered(study(vary, answers=answers)).sentences)


def test_worst_case_inside_the_tolerances():
    """At resonance the response is largest: |k - J omega^2| = 0, with the smallest damping."""
    vary = {name: {"type": "uniform", "low": "-10 %", "high": "+5 %"} for name in ("k", "c")}
    quantities = {"H": {"type": "response", "output": "theta", "input": "T", "at": f"{F * 1.01} Hz"}}
    answer = {"type": "worst_case", "quantity": "H", "direction": "largest", "tried": 2000}
    (worst,) = answered(study(vary, quantities, answers={"a": answer})).variants
    omega = 2 * np.pi * F * 1.01
    assert worst.value == pytest.approx(1 / (0.36 * omega), rel=1e-7)
    assert worst.variant["k"] == pytest.approx(J * omega**2, rel=1e-4)
    assert worst.at_lower == ("c",)
    assert worst.nominal == pytest.approx(1 / abs(K - J * omega**2 + 0.4j * omega), rel=1e-9)
    assert worst.singly == pytest.approx(worst.value, rel=1e-9)
    assert worst.confirmed


def test_tornado_ends():
    found = answered(study(answers={"a": {"type": "tornado", "span": "standard deviation"}}))
    one = found.swings["as given", "f"]
    assert one.middle == pytest.approx(F, rel=1e-9)
    assert one.at_high == pytest.approx(F * np.exp([-SPREAD / 2, SPREAD / 2]), rel=1e-9)
    assert one.at_low == pytest.approx(F * np.exp([SPREAD / 2, -SPREAD / 2]), rel=1e-9)


def test_map_of_a_frequency():
    vary = {
        "J": {"type": "range", "low": 0.1, "high": 0.3, "count": 3},
        "k": {"type": "uniform", "low": K / 2, "high": K},
    }
    answer = {"type": "map", "x": "J", "y": "k", "quantity": "f", "points": 5}
    one = answered(study(vary, answers={"a": answer})).maps["as given"]
    assert one.x == pytest.approx([0.1, 0.2, 0.3])
    assert one.values == pytest.approx(np.sqrt(np.linspace(K / 2, K, 5) / one.x[:, None]) / (2 * np.pi), rel=1e-9)


def test_map_with_others_that_vary():
    vary = {name: {"type": "uniform", "low": "-10 %", "high": "+10 %"} for name in ("J", "k", "c")}
    quantities = {"zeta": {"type": "damping_ratio", "mode": 1}}
    answer = {"type": "map", "x": "J", "y": "k", "quantity": "zeta", "points": 3, "others": "largest", "draws": 200}
    one = answered(study(vary, quantities, answers={"a": answer})).maps["as given"]
    expected = 0.44 / (2 * np.sqrt(one.x[:, None] * one.y))
    assert (one.values < expected).all()
    assert one.values == pytest.approx(expected, rel=2e-3)


def test_scatter_and_parallel_coordinates():
    one = study(
        limits={"f": {"below": at_quantile(1)}},
        answers={"a": {"type": "scatter"}, "b": {"type": "parallel_coordinates"}},
    )
    correlations = answered(one).correlations["as given", "f"]
    # Of a sum of two normal variables of equal size Pearson's is 1/sqrt(2); Spearman's of normal ones 6/pi asin(r/2).
    rank = 6 / np.pi * np.arcsin(np.sqrt(0.5) / 2)
    assert correlations.coefficients == pytest.approx([-rank, rank], abs=0.02)
    assert (correlations.low < [-rank, rank]).all()
    found = answered(one, "b")
    within, beyond = found.medians["as given", "f"]
    assert within == pytest.approx(at_quantile(scipy.stats.norm.ppf(scipy.stats.norm.cdf(1) / 2)), rel=0.005)
    assert beyond == pytest.approx(at_quantile(-scipy.stats.norm.ppf(scipy.stats.norm.sf(1) / 2)), rel=0.005)


def test_percentile_bands():
    vary = {"k": {"type": "uniform", "low": K / 2, "high": K}}
    quantities = {
        "H": {"type": "response", "output": "theta", "input": "T", "band": ["0.01 Hz", "0.1 Hz"], "points": 3}
    }
    answer = {"type": "percentile_bands", "quantity": "H", "percentiles": [90, 10, 50]}
    found = answered(study(vary, quantities, answers={"a": answer}))
    assert found.percentiles == (10, 50, 90)
    for share, line in zip((0.1, 0.5, 0.9), found.lines["as given"], strict=True):
        assert line == pytest.approx(np.full(3, 1 / (K - share * K / 2)), rel=0.02)


ANSWERS = {
    "y": {"type": "yield"},
    "s": {"type": "sobol_indices", "count": 64},
    "p": {"type": "failure_probability", "count": 6000},
    "w": {"type": "worst_case", "quantity": "f", "tried": 100, "direction": "largest"},
    "t": {"type": "tornado"},
    "m": {"type": "map", "x": "J", "y": "k", "quantity": "f", "points": 4},
    "c": {"type": "scatter"},
    "l": {"type": "parallel_coordinates"},
    "b": {"type": "percentile_bands", "quantity": "H"},
}


@pytest.fixture(scope="module")
def everything():
    one = study(
        quantities={"f": UNDAMPED, "H": {"type": "response", "output": "theta", "input": "T", "band": ["1 Hz", "60 Hz"]}},
        configurations=["soft", "stiff"], limits={"f": {"below": at_quantile(1), "above": 1.0}}, answers=ANSWERS,
        sampling={"count": 300, "method": "sobol"},
    )  # fmt: skip
    return one, run_study(one)


@pytest.mark.slow
@pytest.mark.parametrize("name", ANSWERS)
def test_every_answer_has_words_a_table_data_and_a_picture(everything, name):
    one, result = everything
    found, again = (one.answers[name].conclude(one, result) for _ in range(2))
    assert found.sentences
    assert "soft" in str(found.table())
    assert json.dumps(found.to_data(), allow_nan=False) == json.dumps(again.to_data(), allow_nan=False)
    figure = found.figure()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    assert any(labels) or name == "l"
    figure.draw_without_rendering()


@pytest.mark.parametrize(("answer", "said"), [
    ({"type": "yield", "limits": ["g"]}, r"answers\.a\.limits\.0: .*unknown-name"),
    ({"type": "yield", "weights": {"hard": 1}}, r"answers\.a\.weights\.hard: .*unknown-configuration"),
    ({"type": "sobol_indices", "quantities": ["H"]}, "H is a curve"),
    ({"type": "sobol_indices", "count": 100}, r"answers\.a\.count: .*128.*out-of-range"),
    ({"type": "worst_case", "quantity": "g"}, r"answers\.a\.quantity: .*unknown-name"),
    ({"type": "map", "x": "J", "y": "J", "quantity": "f"}, r"answers\.a\.y: .*contradicting-entries"),
    ({"type": "map", "x": "J", "y": "m", "quantity": "f"}, r"answers\.a\.y: .*unknown-name"),
    ({"type": "percentile_bands", "quantity": "f"}, r"answers\.a\.quantity: .*not-applicable"),
    ({"type": "failure_probability", "limits": ["H"]}, r"answers\.a\.limits\.0: .*unknown-name"),
])  # fmt: skip
def test_what_does_not_fit_is_said(answer, said):
    with pytest.raises(ModelError, match=said):
        study(
            quantities={"f": UNDAMPED, "H": {"type": "response", "output": "theta", "input": "T", "band": ["1 Hz", "9 Hz"]}},
            limits={"f": {"below": 40.0}}, answers={"a": answer},
        )  # fmt: skip


def test_answers_that_draw_need_a_distribution():
    with pytest.raises(ModelError, match=r"answers\.a: .*nothing-varies"):
        study({"k": {"type": "list", "values": [K]}}, sampling=None, answers={"a": {"type": "sobol_indices"}})
    with pytest.raises(ModelError, match=r"answers\.a: .*missing-entry"):
        study(answers={"a": {"type": "failure_probability"}})


def test_yield_of_what_hardly_varies():
    """The same number but for rounding, as a mean torque that no tolerance moves, has a histogram, too."""
    asked = {
        "theta": {"type": "response", "output": "theta_1", "input": "T_M", "at": "5 Hz"},
        "same": {"type": "expression", "of": "0.843318*theta/theta"},
    }
    study = tn.study.define(
        tn.load("amt_rig"), {"k_1": {"type": "normal", "deviation": "4 %"}}, asked, sampling={"count": 50},
        limits={"same": {"below": 0.8}}, answers={"kept": {"type": "yield"}},
    )  # fmt: skip
    found = study.answers["kept"].conclude(study, tn.study.run_study(study))
    assert "100 % (93 to 100 %)" in found.sentences[0]
    assert len(found.figure().axes) == 1
