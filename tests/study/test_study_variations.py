"""Distributions of parameters against scipy.stats, and what is said of values that make none."""

import math

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

import torsionnet as tn
from torsionnet.base.errors import ModelError
from torsionnet.base.units import DIMENSIONS
from torsionnet.study.space.variations.normal import (
    Lognormal,
    Normal,
    NormalMarginal,
    TruncatedMarginal,
    normal_quantile,
)
from torsionnet.study.space.variations.uniform import ListOfValues, Triangular, Uniform, ValueRange
from torsionnet.study.space.variations.variation import VARIATIONS, GridAxis, Nominal, NominalReader, nominals

STIFFNESS = Nominal("k", 500.0, DIMENSIONS["stiffness"], "N*m/rad")
SHARES = np.array([1e-12, 1e-6, 0.01, 0.2, 0.5, 0.7, 0.99, 1 - 1e-6])


def bound(variation, nominal=STIFFNESS):
    reader = NominalReader(nominal)
    found = variation.bound(reader)
    assert reader.faults == []
    return found


def faults(variation, nominal=STIFFNESS):
    reader = NominalReader(nominal)
    assert variation.bound(reader) is None
    return [(".".join(map(str, fault.path)), fault.kind) for fault in reader.faults if "NaN" not in fault.message]


def scipy_lognormal(mean, deviation):
    spread = math.log(1 + (deviation / mean) ** 2)
    return scipy.stats.lognorm(math.sqrt(spread), scale=mean * math.exp(-spread / 2))


def truncated_by_scipy(whole, low, high):
    """Shares of a scipy distribution between two limits, as scipy has none for any but the normal one."""

    class Part:
        mass = whole.cdf(high) - whole.cdf(low)

        def ppf(self, p):
            return whole.ppf(whole.cdf(low) + p * self.mass)

        def cdf(self, x):
            return (whole.cdf(np.clip(x, low, high)) - whole.cdf(low)) / self.mass

        def logpdf(self, x):
            return np.where((x >= low) & (x <= high), whole.logpdf(x) - np.log(self.mass), -np.inf)

    return Part()


CASES = {
    "normal": (Normal(mean="460 N*m/rad", deviation="5 %"), lambda: scipy.stats.norm(460, 23)),
    "normal of the model's mean": (Normal(deviation="10 N*m/rad"), lambda: scipy.stats.norm(500, 10)),
    "truncated normal": (
        Normal(deviation="20 %", low="-30 %", high="0.52 kN*m/rad"),
        lambda: scipy.stats.truncnorm(-1.5, 0.2, 500, 100),
    ),
    "one side of a normal": (Normal(deviation="20 %", low=650), lambda: scipy.stats.truncnorm(1.5, math.inf, 500, 100)),
    "lognormal": (Lognormal(deviation="30 %"), lambda: scipy_lognormal(500, 150)),
    "truncated lognormal": (
        Lognormal(deviation="30 %", low=400, high=900),
        lambda: truncated_by_scipy(scipy_lognormal(500, 150), 400, 900),
    ),
    "uniform": (Uniform(low="-10 %", high="+20 %"), lambda: scipy.stats.uniform(450, 150)),
    "triangular": (Triangular(low="-10 %", high="+30 %"), lambda: scipy.stats.triang(0.25, 450, 200)),
    "only rising": (Triangular(low=400, mode=500, high=500), lambda: scipy.stats.triang(1, 400, 100)),
    "only falling": (Triangular(low=500, mode=500, high=600), lambda: scipy.stats.triang(0, 500, 100)),
}


@pytest.fixture(params=CASES, name="case")
def a_case(request):
    variation, expected = CASES[request.param]
    return bound(variation), expected()


def test_shares_and_values_are_those_of_scipy(case):
    ours, expected = case
    values = expected.ppf(SHARES)
    assert ours.ppf(SHARES) == pytest.approx(values, rel=1e-9)
    assert ours.isf(1 - SHARES[2:]) == pytest.approx(values[2:], rel=1e-9)
    assert ours.cdf(values) == pytest.approx(SHARES, rel=2e-6)
    assert ours.sf(values) == pytest.approx(1 - SHARES, rel=2e-6)
    assert ours.log_density(values) == pytest.approx(expected.logpdf(values), rel=1e-7)


def test_density_is_the_slope_of_the_share(case):
    ours, _ = case
    values = ours.ppf(np.array([0.1, 0.35, 0.6, 0.9]))
    step = 1e-4
    slope = (ours.cdf(values + step) - ours.cdf(values - step)) / (2 * step)
    assert np.exp(ours.log_density(values)) == pytest.approx(slope, rel=1e-6)


def test_nothing_is_outside_the_limits(case):
    ours, _ = case
    for end, beyond in ((ours.low, -1.0), (ours.high, 1.0)):
        if np.isfinite(end):
            assert ours.log_density(end + beyond) == -np.inf
            assert (ours.cdf(end + beyond), ours.sf(end + beyond)) == ((0, 1) if beyond < 0 else (1, 0))
    tails = ours.from_normal(np.array([-35.0, 35.0]))
    assert np.isfinite(tails).all()
    assert ours.low <= tails[0] < tails[1] <= ours.high


@given(st.floats(-7, 7))
def test_normal_variables_lead_there_and_back(u):
    for variation, _ in CASES.values():
        marginal = bound(variation)
        # A value near a limit has only so many digits from it.
        there = marginal.from_normal(u)
        assert marginal.from_normal(marginal.to_normal(there)) == pytest.approx(float(there), rel=1e-12)
    for variation in (CASES["normal"][0], CASES["lognormal"][0]):
        marginal = bound(variation)
        assert float(marginal.to_normal(marginal.from_normal(u))) == pytest.approx(u, abs=1e-12)


def test_quantiles_of_a_normal_are_those_of_scipy():
    shares = np.concatenate([10.0 ** np.arange(-308, 0), np.linspace(0, 1, 999), 1 - 10.0 ** np.arange(-15, 0)])
    assert np.allclose(normal_quantile(shares), scipy.special.ndtri(shares), rtol=1e-15, atol=0)
    assert np.isnan(normal_quantile([-0.1, 1.1, np.nan])).all()


def test_a_far_tail_of_a_normal_keeps_its_digits():
    marginal = TruncatedMarginal(NormalMarginal(500, 10), 580, math.inf)
    expected = scipy.stats.truncnorm(8, math.inf, 500, 10)
    assert marginal.share == pytest.approx(scipy.stats.norm.sf(8), rel=1e-12)
    assert marginal.ppf(SHARES) == pytest.approx(expected.ppf(SHARES), rel=1e-10)
    assert marginal.cdf(595.0) == pytest.approx(float(expected.cdf(595.0)), rel=1e-9)


def test_lognormal_mean_and_deviation_are_those_of_the_values():
    marginal = bound(Lognormal(mean=460, deviation=92))
    values = marginal.ppf((np.arange(400_000) + 0.5) / 400_000)
    assert (values.mean(), values.std()) == (pytest.approx(460, rel=1e-5), pytest.approx(92, rel=1e-3))


def test_a_list_has_its_values():
    axis = bound(ListOfValues(values=["-10 %", "0 %", "0.6 kN*m/rad", 700]))
    assert isinstance(axis, GridAxis)
    assert axis.values.tolist() == [450, 500, 600, 700]
    assert (axis.count, axis.low, axis.high) == (4, 450, 700)


def test_a_range_is_numpys():
    assert bound(ValueRange(low="-10 %", high=600, count=7)).values == pytest.approx(
        np.linspace(450, 600, 7), rel=1e-15
    )
    logs = bound(ValueRange(low=1, high=1000, count=4, spacing="log")).values
    assert logs == pytest.approx(np.geomspace(1, 1000, 4), rel=1e-15)
    assert (logs[0], logs[-1]) == (1, 1000)


@given(st.floats(1e-6, 1), st.floats(1.01, 1e6), st.integers(2, 50), st.sampled_from(["linear", "log"]))
def test_both_ends_of_a_range_are_exact(low, high, count, spacing):
    values = bound(ValueRange(low=low, high=high, count=count, spacing=spacing)).values
    assert (values[0], values[-1]) == (low, high)
    assert (np.diff(values) > 0).all()


def test_the_end_of_a_long_range_costs_nothing():
    axis = bound(ValueRange(low=1, high=3, count=1e9))
    assert axis.at(np.array([0, 999_999_999])).tolist() == [1, 3]


def test_percent_of_a_negative_value_is_below_and_above_it():
    torque = Nominal("T", -200.0, DIMENSIONS["torque"])
    marginal = bound(Uniform(low="-10 %", high="+5 %"), torque)
    assert (marginal.low, marginal.high) == (-220, -190)
    assert bound(Normal(deviation="10 %"), torque).deviation == 20


@pytest.mark.parametrize(
    ("variation", "where", "kind"),
    [
        (
            Normal(deviation="5 kg"),
            "deviation",
            "wrong-unit",
        ),
        (Normal(mean="5 kg", deviation="5 %"), "mean", "wrong-unit"),
        (Normal(deviation="-5 %"), "deviation", "out-of-range"),
        (Normal(deviation=0), "deviation", "out-of-range"),
        (Normal(deviation=0.05), "deviation", "implausible-size"),
        (Normal(mean=0, deviation="5 %"), "deviation", "out-of-range"),
        (Normal(deviation="5 %", low=600, high=550), "low", "unordered-rows"),
        (Normal(deviation="1 %", low=600), "low", "out-of-range"),
        (Lognormal(mean=-5, deviation=1), "mean", "out-of-range"),
        (Uniform(low="-10 %", high="10 %"), "high", "ambiguous-number"),
        (Uniform(low="+10 %", high="-10 %"), "low", "unordered-rows"),
        (Triangular(low=550, high=600), "", "out-of-range"),
        (Triangular(low=550, mode=700, high=600), "mode", "out-of-range"),
        (ListOfValues(values=[500, "0 %"]), "values.1", "repeated-name"),
        (ListOfValues(values=[500, "1 kg"]), "values.1", "wrong-unit"),
        (ValueRange(low=3, high=2, count=5), "low", "unordered-rows"),
        (ValueRange(low=0, high=2, count=5, spacing="log"), "low", "out-of-range"),
    ],
)
def test_values_that_make_no_distribution(variation, where, kind):
    assert faults(variation) == [(where, kind)]


@pytest.mark.parametrize(
    ("nominal", "kind"),
    [
        (Nominal("k", None, DIMENSIONS["stiffness"]), "missing-entry"),
        (Nominal("k", 0.0, DIMENSIONS["stiffness"]), "out-of-range"),
        (
            Nominal("k", 0.05, None, in_percent=True),
            "ambiguous-number",
        ),
    ],
)
def test_shares_of_nothing(nominal, kind):
    assert faults(Uniform(low="-10 %", high="+10 %"), nominal)[0] == ("low", kind)


def test_all_faults_of_a_variation_are_told():
    assert len(faults(Normal(mean="3 s", deviation="-4 %", low="5 %", high="2 kg"))) == 4


def test_the_model_says_value_and_unit():
    rig = tn.load("amt_rig")
    assert nominals(rig, ["k_2"])["k_2"] == Nominal("k_2", 12300.0, DIMENSIONS["stiffness"], "N*m/rad")
    shaft = tn.Drivetrain(
        "shaft",
        [
            tn.Inertia("disc", node="a", inertia=1),
            tn.Spring("s", nodes=("a", "ground"), stiffness="k", damping={"zeta": "z", "at": "10 Hz"}),
        ],
        parameters={"k": 100, "z": "2 %"},
    )
    found = nominals(shaft, ["k", "z"])
    assert (found["k"].dimension, found["k"].unit) == (DIMENSIONS["stiffness"], "N*m/rad")
    assert (found["z"].in_percent, found["z"].value) == (True, 0.02)


@pytest.mark.parametrize(
    ("variation", "raw", "kind"),
    [
        (Normal, {"deviaton": 3}, "unknown-entry"),
        (Normal, {}, "missing-entry"),
        (Normal, {"deviation": "k_1/2"}, "expression-not-allowed"),
        (Normal, {"deviation": 1e300}, "implausible-size"),
        (ListOfValues, {"values": []}, "missing-entry"),
        (ListOfValues, {"values": 3}, "wrong-form"),
        (ValueRange, {"low": 1, "high": 2, "count": 1}, "out-of-range"),
        (ValueRange, {"from": 1, "high": 2, "count": 3}, "unknown-entry"),
        (ValueRange, {"low": 1, "high": 2, "count": 3, "spacing": "lin"}, "unknown-word"),
    ],
)
def test_entries_that_cannot_be_read(variation, raw, kind):
    found, wrong = variation.read(raw)
    assert found is None
    assert kind in [fault.kind for fault in wrong]


def test_python_refuses_the_same():
    with pytest.raises(ModelError, match=r"deviation: .*expression-not-allowed"):
        Normal(deviation="k_1/2")


@pytest.mark.parametrize("variation", [variation for variation, _ in CASES.values()])
def test_round_trip(variation):
    again, wrong = type(variation).read(variation.to_data())
    assert wrong == []
    assert again == variation


def test_every_type_is_found_by_its_word():
    assert list(VARIATIONS) == ["list", "lognormal", "normal", "range", "triangular", "uniform"]
    assert VARIATIONS["range"] is ValueRange
