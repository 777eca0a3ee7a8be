"""Spaces of variants: by index whatever is asked for, with the statistics that were asked for, and what makes none."""

import math
import pickle
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st
from support.faults import is_as_expected

import torsionnet as tn
import torsionnet.study.space.samples as sampling_points
from torsionnet.base.errors import ModelError
from torsionnet.study.space.correlation import Correlation, CorrelationOfPair, HermiteSeries
from torsionnet.study.space.samples import LatinHypercubePoints, Samples, permuted
from torsionnet.study.space.space import Space, SpaceEntries
from torsionnet.study.space.variations.normal import Lognormal, LognormalMarginal, Normal, NormalMarginal
from torsionnet.study.space.variations.uniform import ListOfValues, Triangular, Uniform, UniformMarginal, ValueRange
from torsionnet.study.study_file import space_faults

RIG = tn.load("amt_rig")
METHODS = ("random", "latin_hypercube", "sobol")
RANDOM = {
    "k_1": Lognormal(deviation="40 %"),
    "k_2": Normal(deviation="5 %"),
    "c_1": Triangular(low="-50 %", high="+20 %"),
    "c_B": Uniform(low=1, high=2),
}
GRID = {"c_O": ListOfValues(values=[170, 360]), "tau": ValueRange(low=3, high=8, count=3)}
TOGETHER = (Correlation(between=["k_1", "k_2"], coefficient=0.6), Correlation(between=["k_1", "c_B"], coefficient=-0.4))


def space(vary=RANDOM, correlation=(), **sampling):
    return Space(RIG, vary, correlation, Samples(**sampling) if sampling else None)


def same(first, second):
    return first.keys() == second.keys() and all(np.array_equal(first[name], second[name]) for name in first)


def joined(parts):
    parts = list(parts)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


# By index


@pytest.mark.few(1)
@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=20)
@given(data=st.data())
def test_variants_are_the_same_however_they_are_cut(method, data):
    whole = space({**RANDOM, **GRID}, TOGETHER, method=method, count=5000, seed=3)
    assert whole.count == 30_000
    cuts = sorted(data.draw(st.lists(st.integers(0, whole.count), max_size=4, unique=True)))
    start, stop = sorted(data.draw(st.lists(st.integers(0, whole.count), min_size=2, max_size=2)))
    edges = [start, *(cut for cut in cuts if start < cut < stop), stop]
    parts = joined(whole.values(begin, end) for begin, end in pairwise(edges))
    assert same(parts, whole.values(start, stop))
    again = pickle.loads(pickle.dumps(space({**RANDOM, **GRID}, TOGETHER, method=method, count=5000, seed=3)))
    assert same(parts, again.values(start, stop))


@pytest.mark.parametrize("method", METHODS)
def test_another_seed_draws_others_and_none_twice(method):
    first, second = (space(method=method, count=2048, seed=seed).values(0, 2048)["k_1"] for seed in (1, 2))
    assert len(np.unique(np.concatenate([first, second]))) == 4096


@pytest.mark.parametrize("method", ["random", "latin_hypercube"])
def test_draws_of_a_parameter_stay_when_another_one_varies_too(method):
    few = space({"k_2": RANDOM["k_2"]}, method=method, count=5000).values(4000, 5000)
    many = space(method=method, count=5000).values(4000, 5000)
    assert np.array_equal(few["k_2"], many["k_2"])


def test_a_grid_is_crossed_with_all_draws():
    whole = space({"c_O": GRID["c_O"], "k_2": RANDOM["k_2"], "tau": GRID["tau"]}, count=4)
    found = whole.values(0, whole.count)
    assert (whole.names, whole.random_names, whole.draws) == (("c_O", "k_2", "tau"), ("k_2",), 4)
    assert list(found) == ["c_O", "k_2", "tau"]
    assert found["c_O"].tolist() == [170] * 12 + [360] * 12
    assert found["tau"].tolist() == ([3] * 4 + [5.5] * 4 + [8] * 4) * 2
    assert np.array_equal(found["k_2"], np.tile(found["k_2"][:4], 6))
    assert {name: axis.values.tolist() for name, axis in whole.grid.items()} == {"c_O": [170, 360], "tau": [3, 5.5, 8]}


def test_a_grid_alone_needs_no_draws():
    whole = space(GRID)
    assert (whole.count, whole.draws) == (6, 1)
    assert whole.values(1, 4) == {"c_O": pytest.approx([170, 170, 360]), "tau": pytest.approx([5.5, 8, 3])}


def test_variants_of_a_grid_beyond_all_integers_can_be_had():
    huge = space(
        {"c_O": ValueRange(low=0, high=1e9 - 1, count=1e9), "tau": ValueRange(low=1, high=10**9, count=1e9), **RANDOM},
        count=1e9,
    )
    assert huge.count == 10**27
    index = (123_456_789 * 10**9 + 999_999_998) * 10**9 + 10**9 - 2
    found = huge.values(index, index + 4)
    assert found["c_O"] == pytest.approx([123_456_789] * 4, rel=1e-15)
    assert found["tau"] == pytest.approx([999_999_999] * 2 + [10**9] * 2, rel=1e-15)
    drawn = huge.values(10**9 - 2, 10**9)["k_2"]
    assert np.array_equal(found["k_2"], np.concatenate([drawn, huge.values(0, 2)["k_2"]]))


def test_a_billion_points_cost_no_more_than_a_thousand():
    for method in ("random", "latin_hypercube"):
        far = space(method=method, count=10**12).values(10**12 - 1000, 10**12)
        assert all(np.isfinite(column).all() for column in far.values())


def test_without_sampling_nothing_is_drawn():
    empty = space()
    assert (empty.count, empty.values(0, 0)["k_1"].tolist()) == (0, [])
    with pytest.raises(IndexError, match="asked for 0 to 0"):
        empty.values(0, 1)


# Draws


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("correlation", [(), TOGETHER])
def test_draws_have_their_distributions(method, correlation):
    count = 2**16
    found = space(correlation=correlation, method=method, count=count, seed=5).values(0, count)
    spread = math.log(1 + 0.4**2)
    expected = {
        "k_1": scipy.stats.lognorm(math.sqrt(spread), scale=460 * math.exp(-spread / 2)),
        "k_2": scipy.stats.norm(12_300, 615),
        "c_1": scipy.stats.triang(5 / 7, 2, 2.8),
        "c_B": scipy.stats.uniform(1, 1),
    }
    for name, law in expected.items():
        assert scipy.stats.kstest(found[name], law.cdf).pvalue > 1e-3, name
        assert found[name].mean() == pytest.approx(law.mean(), abs=4 * law.std() / math.sqrt(count))


def test_random_draws_are_independent_from_one_to_the_next():
    found = space(count=200_000, seed=2)
    shares = scipy.stats.norm.cdf(found.to_standard_normal(found.values(0, 200_000)))
    columns = [*shares.T, *np.roll(shares, 1, axis=0).T]
    off = np.corrcoef(columns) - np.eye(8)
    assert abs(off).max() < 5 / math.sqrt(200_000)
    # Blocks are no copies of each other.
    assert len(np.unique(shares)) == shares.size


@pytest.mark.parametrize("count", [1, 2, 7, 100, 4096, 10_007])
def test_a_latin_hypercube_has_one_draw_in_each_part(count):
    found = space(method="latin_hypercube", count=count, seed=4)
    shares = scipy.stats.norm.cdf(found.to_standard_normal(found.values(0, count)))
    for column in shares.T:
        assert sorted(np.floor(column * count).astype(int)) == list(range(count))


def test_parameters_of_a_latin_hypercube_are_unrelated():
    count = 10_000
    worst = []
    for seed in range(20):
        found = space(method="latin_hypercube", count=count, seed=seed)
        normal = found.to_standard_normal(found.values(0, count))
        worst.append(abs(np.corrcoef(normal.T) - np.eye(4)).max())
    # Of 6 pairs, the largest of a normal law with the deviation 1/sqrt(n); 20 draws of it.
    assert 1 < np.median(worst) * math.sqrt(count) < 2.5
    assert max(worst) * math.sqrt(count) < 5


@given(st.integers(1, 3000) | st.integers(4090, 20_000), st.integers(0, 2**32 - 1))
def test_every_number_comes_once_in_a_permutation(count, seed):
    order = permuted(np.arange(count), count, np.random.SeedSequence(seed))
    assert np.array_equal(np.sort(order), np.arange(count))


def test_every_order_of_five_is_as_frequent():
    seen = Counter(tuple(permuted(np.arange(5), 5, np.random.SeedSequence(seed)).tolist()) for seed in range(6000))
    assert len(seen) == 120
    assert scipy.stats.chisquare(list(seen.values())).pvalue > 1e-3


def test_the_last_part_of_the_most_stays_below_one(monkeypatch):
    count = 10**15
    with pytest.raises(ModelError, match=f"from 1 to {count}, got {count + 1}"):
        Samples(count=count + 1)
    monkeypatch.setattr(sampling_points, "permuted", lambda places, count, _: np.full(len(places), count - 1))
    shares = LatinHypercubePoints(("k",), count, 1)(0, 1000)
    assert (count - 1) / count <= shares.min() <= shares.max() < 1


def test_places_and_numbers_of_a_large_permutation_are_unrelated():
    count = 100_000
    order = permuted(np.arange(count), count, np.random.SeedSequence(8))
    table, _, _ = np.histogram2d(np.arange(count), order, bins=50)
    assert scipy.stats.chisquare(table.ravel()).pvalue > 1e-3
    assert abs(np.corrcoef(order[1:], order[:-1])[0, 1]) < 4 / math.sqrt(count)


@pytest.mark.parametrize("count", [1, 5, 1024, 4096, 20_000])
def test_a_sobol_sequence_is_scipys(count):
    theirs = scipy.stats.qmc.Sobol(4, scramble=True, seed=np.random.default_rng(11))
    expected = theirs.random(2 ** math.ceil(math.log2(count)))[:count]
    found = space(method="sobol", count=count, seed=11)
    shares = scipy.stats.norm.cdf(found.to_standard_normal(found.values(0, count)))
    assert abs(shares - expected).max() < 2.0**-30


def test_a_late_stretch_of_a_sobol_sequence_is_scipys():
    theirs = scipy.stats.qmc.Sobol(4, scramble=True, seed=np.random.default_rng(1))
    theirs.fast_forward(2**22 + 12_345)
    expected = theirs.random(100)
    found = space(method="sobol", count=2**23)
    shares = scipy.stats.norm.cdf(found.to_standard_normal(found.values(2**22 + 12_345, 2**22 + 12_445)))
    assert abs(shares - expected).max() < 2.0**-30


# Correlation


def test_two_lognormal_parameters_have_the_closed_form():
    first, second, rho = 0.4, 1.0, 0.5
    expected = math.log(1 + rho * first * second) / math.sqrt(math.log(1 + first**2) * math.log(1 + second**2))
    pair = CorrelationOfPair(HermiteSeries(LognormalMarginal(460, 184)), HermiteSeries(LognormalMarginal(3, 3)))
    assert pair.of_normals(rho) == pytest.approx(expected, rel=1e-9)
    widest = math.sqrt(math.log(1 + first**2) * math.log(1 + second**2))
    limits = [(math.exp(sign * widest) - 1) / (first * second) for sign in (-1, 1)]
    assert pair.range == pytest.approx(limits, rel=1e-9)


@pytest.mark.parametrize("rho", [-0.95, -0.3, 0.0, 0.7, 0.99])
def test_uniform_and_normal_parameters_have_their_closed_forms(rho):
    uniform, normal = HermiteSeries(UniformMarginal(2, 5)), HermiteSeries(NormalMarginal(7, 0.1))
    assert CorrelationOfPair(uniform, uniform).of_normals(rho) == pytest.approx(
        2 * math.sin(math.pi * rho / 6), abs=1e-9
    )
    assert CorrelationOfPair(normal, normal).of_normals(rho) == pytest.approx(rho, abs=1e-12)
    assert CorrelationOfPair(uniform, normal).of_values(rho) == pytest.approx(rho * math.sqrt(3 / math.pi), abs=1e-9)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("rho", [-0.4, 0.4])
def test_a_spread_below_the_last_digit_is_correlated_like_a_normal_one(rho):
    """x = mean + 1e-30 z is its mean in doubles; a lognormal parameter beside it has the closed form of a normal one."""
    deviation = 0.1
    pair = CorrelationOfPair(
        HermiteSeries(NormalMarginal(7, 1e-30)), HermiteSeries(LognormalMarginal(3, 3 * deviation))
    )
    expected = rho * deviation / math.sqrt(math.log(1 + deviation**2))
    assert pair.of_normals(rho) == pytest.approx(expected, rel=1e-9)


def test_values_have_the_correlation_that_was_asked_for():
    count = 100_000
    for method in METHODS:
        found = space(correlation=TOGETHER, method=method, count=count, seed=6).values(0, count)
        rho = np.corrcoef([found[name] for name in RANDOM])
        expected = np.eye(4)
        expected[0, 1] = expected[1, 0] = 0.6
        expected[0, 3] = expected[3, 0] = -0.4
        assert rho == pytest.approx(expected, abs=4 / math.sqrt(count)), method


def test_one_coefficient_for_several():
    several = Correlation(between=["k_1", "k_2", "c_B"], coefficient=0.5)
    found = space(correlation=(several,), count=50_000).values(0, 50_000)
    rho = np.corrcoef([found[name] for name in several.between])
    assert rho[np.triu_indices(3, 1)] == pytest.approx([0.5] * 3, abs=0.02)


def test_joint_density_is_that_of_two_normal_variables():
    vary = {"k_1": Normal(deviation=46), "k_2": Normal(deviation=615)}
    found = space(vary, (Correlation(between=["k_2", "k_1"], coefficient=0.7),))
    law = scipy.stats.multivariate_normal([460, 12_300], [[46**2, 0.7 * 46 * 615], [0.7 * 46 * 615, 615**2]])
    points = {"k_1": np.array([400.0, 460, 500]), "k_2": np.array([12_000.0, 13_000, 12_400])}
    assert found.log_density(points) == pytest.approx(law.logpdf(np.column_stack(list(points.values()))), rel=1e-9)


@pytest.mark.slow
def test_joint_density_is_a_density():
    found = space({"c_B": RANDOM["c_B"], "c_1": RANDOM["c_1"]}, (Correlation(between=["c_1", "c_B"], coefficient=0.8),))
    x, y = np.meshgrid(1 + (np.arange(1000) + 0.5) / 1000, 2 + 2.8 * (np.arange(1000) + 0.5) / 1000)
    density = np.exp(found.log_density({"c_B": x.ravel(), "c_1": y.ravel()}))
    assert density.sum() * 2.8e-6 == pytest.approx(1, abs=2e-3)
    outside = {"c_B": np.array([0.9, 1.5]), "c_1": np.array([3.0, 5.0])}
    assert found.log_density(outside).tolist() == [-np.inf, -np.inf]


@pytest.mark.parametrize("correlation", [(), TOGETHER])
def test_standard_normal_variables_lead_there_and_back(correlation):
    found = space(correlation=correlation)
    u = np.random.default_rng(3).standard_normal((500, 4))
    assert found.to_standard_normal(found.from_standard_normal(u)) == pytest.approx(u, abs=1e-10)
    shares = scipy.stats.norm.cdf(u)
    unit, normal = found.from_unit(shares), found.from_standard_normal(u)
    assert all(unit[name] == pytest.approx(normal[name], rel=1e-10) for name in RANDOM)


# Around it


def test_a_box_ends_at_limits_or_three_deviations():
    box = space({**RANDOM, **GRID, "c_M": Normal(deviation="10 %", low=0, high="+5 %")}).box()
    assert list(box) == [*RANDOM, *GRID, "c_M"]
    assert box["c_1"] == (2.0, 4.8)
    assert (box["c_O"], box["tau"], box["c_B"]) == ((170, 360), (3, 8), (1, 2))
    assert box["k_2"] == pytest.approx((12_300 - 3 * 615, 12_300 + 3 * 615), rel=1e-5)
    assert box["c_M"] == (0, pytest.approx(0.315))
    spread = math.log(1 + 0.4**2)
    law = scipy.stats.lognorm(math.sqrt(spread), scale=460 * math.exp(-spread / 2))
    assert box["k_1"] == pytest.approx(law.ppf([0.00135, 0.99865]), rel=1e-9)


def test_values_follow_the_configuration_they_are_relative_to():
    base = space({"tau": Uniform(low="-10 %", high="+10 %"), "k_2": Normal(mean=9000, deviation=100)}, count=50)
    fifth = base.at(RIG.configured("V"))
    here, there = base.values(0, 50), fifth.values(0, 50)
    assert there["tau"] / here["tau"] == pytest.approx(np.full(50, 3.26 / 7.96))
    assert np.array_equal(here["k_2"], there["k_2"])
    assert (base.nominal["tau"], fifth.nominal["tau"]) == (7.96, 3.26)


def test_a_variation_that_makes_configurations_alike_is_told():
    models = {name: RIG.configured(name) for name in ("IV", "V")}
    alike = {"tau": Uniform(low=3, high=4), "k_2": Normal(deviation="5 %")}
    [fault] = space_faults(space(alike), models)
    assert (fault.severity, fault.path, fault.kind) == ("warning", ("vary", "tau"), "contradicting-values")
    assert "tau" in fault.message
    assert "IV, V" in fault.message
    [fault] = space_faults(space({"tau": ValueRange(low=3, high=4, count=5)}), models)
    assert fault.path == ("vary", "tau")
    assert (
        space_faults(space({"tau": Uniform(low="-10 %", high="+10 %"), "k_2": Normal(mean=9000, deviation=90)}), models)
        == []
    )


def test_what_is_wrong_in_one_configuration_is_told_with_its_name():
    whole = space({"tau": Triangular(low=3.5, high=9)})
    [fault] = space_faults(whole, {name: RIG.configured(name) for name in ("II", "V")})
    assert (fault.severity, fault.configuration, fault.path) == ("error", "V", ("vary", "tau"))
    assert fault.kind == "out-of-range"
    assert all(value in fault.message for value in ("(3.26)", "(3.5)", "(9)"))


def test_names_with_dots_vary():
    half = tn.Drivetrain(
        "half shaft",
        [tn.Spring("shaft", nodes=("inner", "hub"), stiffness="k"), tn.Inertia("wheel", node="hub", inertia=0.9)],
        parameters={"k": "9 kN*m/rad"},
        ports=["inner"],
    )
    axle = tn.Drivetrain("axle", [tn.Inertia("cage", node="cage", inertia=0.03)]).with_part(
        "left", half, at={"inner": "cage"}
    )
    found = Space(axle, {"left.k": Uniform(low="-10 %", high="+10 %")}, sampling=Samples(count=10)).values(0, 10)
    assert (abs(found["left.k"] / 9000 - 1) <= 0.1).all()


RAW = {
    "vary": {
        "k_2": {"type": "normal", "deviation": "5 %", "low": 0},
        "k_1": {"type": "lognormal", "mean": "0.46 kN*m/rad", "deviation": "10 %"},
        "c_O": {"type": "list", "values": [170, "360 N*m*s/rad"]},
        "tau": {"type": "range", "low": 3, "high": 8, "count": 4, "spacing": "log"},
    },
    "correlation": [{"between": ["k_1", "k_2"], "coefficient": 0.6}],
    "sampling": {"method": "sobol", "count": 1024, "seed": 7},
}


def read_space(raw, model):
    values, faults = SpaceEntries.read_entries(raw)
    return (None, faults) if faults else Space.of(SpaceEntries(**values), model)


def test_round_trip():
    found, faults = read_space(RAW, RIG)
    assert faults == []
    assert found.to_data() == RAW
    again, _ = read_space(found.to_data(), RIG)
    assert same(found.values(0, 100), again.values(0, 100))


def test_schema_and_reader_agree():
    jsonschema = pytest.importorskip("jsonschema")
    schema = {**SpaceEntries.schema(), "$defs": SpaceEntries.definitions()}
    jsonschema.validate(RAW, schema)
    wrong = {**RAW, "sampling": {"method": "sobel", "count": 10}}
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(wrong, schema)


# What makes no space


def changed(**changes):
    return {
        "vary": {"k_1": {"type": "normal", "deviation": "5 %"}, "k_2": {"type": "normal", "deviation": "5 %"}},
        **changes,
    }


def found_in(raw, model=RIG):
    made, faults = read_space(raw, model)
    assert (made is None) == any(fault.severity == "error" for fault in faults)
    return [(fault.severity, ".".join(map(str, fault.path)), fault) for fault in faults]


def pairs(*coefficients):
    return [{"between": names.split(), "coefficient": rho} for names, rho in coefficients]


FAULTS = [
    ({"vary": {"k_3": RAW["vary"]["k_2"]}}, "vary.k_3", "unknown-parameter"),
    ({"vary": {"gear": {"type": "list", "values": [1]}}}, "vary.gear", "unknown-parameter: an axis of"),
    (
        {"vary": {"half_shaft.stiffness": RAW["vary"]["k_2"]}},
        "vary.half_shaft.stiffness",
        "unknown-parameter: vary k_2",
    ),
    (
        {"vary": {"k_2": {"type": "norml"}}},
        "vary.k_2.type",
        "unknown-word",
    ),
    ({"vary": {}}, "vary", "wrong-form"),
    (
        {"vary": {"k_2": {"type": "normal", "deviation": "50 %"}}},
        "vary.k_2",
        "out-of-range: 2.3 % of k_2",
    ),
    (
        {"vary": {"c_M": {"type": "uniform", "low": -1, "high": 3}}},
        "vary.c_M",
        "out-of-range: 25 % of c_M",
    ),
    ({"vary": {"c_M": {"type": "list", "values": [-1, 3]}}}, "vary.c_M", "out-of-range"),
    ({"vary": {"tau": {"type": "uniform", "low": -1, "high": 3}}}, "vary.tau", "out-of-range"),
    ({"vary": {"tau": {"type": "range", "low": -1, "high": 3, "count": 4}}}, "vary.tau", "out-of-range"),
    (
        {"sampling": {"method": "sobol", "count": 2**30 + 1}},
        "sampling.count",
        "too-large",
    ),
    ({"sampling": {"count": 0}}, "sampling.count", "out-of-range"),
    ({"sampling": {"count": 1.5}}, "sampling.count", "out-of-range"),
    ({"sampling": {"method": "sobol"}}, "sampling", "missing-entry"),
    ({"sampling": {"method": "lhs", "count": 3}}, "sampling.method", "unknown-word"),
    (
        {"vary": {"c_O": RAW["vary"]["c_O"]}, "sampling": {"count": 10}},
        "sampling",
        "needless-entry",
    ),
    (
        {"vary": {**changed()["vary"], "c_O": RAW["vary"]["c_O"]}, "correlation": pairs(("k_1 c_O", 0.5))},
        "correlation.0.between.1",
        "contradicting-entries",
    ),
    (
        {"correlation": pairs(("k_1 k_3", 0.5))},
        "correlation.0.between.1",
        "unknown-name",
    ),
    ({"correlation": pairs(("k_1 k_1", 0.5))}, "correlation.0.between.1", "repeated-name"),
    ({"correlation": pairs(("k_1", 0.5))}, "correlation.0.between", "wrong-count"),
    (
        {"correlation": pairs(("k_1 k_2", 1))},
        "correlation.0.coefficient",
        "out-of-range",
    ),
    ({"correlation": pairs(("k_1 k_2", -1.2))}, "correlation.0.coefficient", "out-of-range"),
    (
        {"correlation": pairs(("k_1 k_2", 0.5), ("k_2 k_1", 0.4))},
        "correlation.1.between",
        "contradicting-entries",
    ),
    (
        {
            "vary": {
                "k_1": {"type": "lognormal", "deviation": "100 %"},
                "k_2": {"type": "lognormal", "deviation": "100 %"},
            },
            "correlation": pairs(("k_1 k_2", -0.6)),
        },
        "correlation.0.coefficient",
        "out-of-range: from -0.500 to 1.000",
    ),
    ({"corelation": []}, "corelation", "unknown-entry"),
]


@pytest.mark.parametrize(("changes", "where", "expected"), FAULTS)
def test_what_makes_no_space(changes, where, expected):
    [(severity, path, fault)] = found_in(changed(**changes))
    assert (severity, path) == ("error", where)
    assert is_as_expected(fault, expected), fault


def test_coefficients_that_contradict_each_other():
    vary = {name: {"type": "normal", "deviation": "5 %"} for name in ("k_1", "k_2", "c_1", "c_B", "c_O")}
    table = pairs(("k_1 k_2", 0.9), ("k_2 c_1", 0.9), ("k_1 c_1", 0.5), ("c_B c_O", 0.3))
    [(_, path, fault)] = found_in({"vary": vary, "correlation": table})
    assert path == "correlation.0.coefficient"
    # The third coefficient of a matrix lies within a b +- sqrt((1 - a^2)(1 - b^2)), here 0.45 +- 0.377.
    assert is_as_expected(fault, "contradicting-values: 0.073 to 0.827")
    smallest = np.linalg.eigvalsh([[1, 0.9, 0.5], [0.9, 1, 0.9], [0.5, 0.9, 1]])[0]
    assert f"smallest eigenvalue is {smallest:.3g}" in fault.message
    table[2]["coefficient"] = 0.63
    assert found_in({"vary": vary, "correlation": table}) == []


def test_values_that_only_their_distributions_contradict():
    vary = {name: {"type": "uniform", "low": "-50 %", "high": "+50 %"} for name in ("k_1", "k_2", "c_1")}
    # Between uniform variables 0.9, 0.9 and 0.6205 make a matrix, but the normal variables behind have 0.908, 0.908, 0.638.
    [(_, _, fault)] = found_in(
        {"vary": vary, "correlation": pairs(("k_1 k_2", 0.9), ("k_2 c_1", 0.9), ("k_1 c_1", 0.6205))}
    )
    assert is_as_expected(fault, "contradicting-values: with these distributions")


def test_two_contradictions_are_two_faults():
    vary = {name: {"type": "normal", "deviation": "5 %"} for name in ("k_1", "k_2", "c_1", "c_B", "c_O", "c_M")}
    signs = [
        ("k_1 k_2", 0.9),
        ("k_2 c_1", 0.9),
        ("k_1 c_1", -0.9),
        ("c_B c_O", 0.9),
        ("c_O c_M", 0.9),
        ("c_B c_M", -0.9),
    ]
    assert [path for _, path, _ in found_in({"vary": vary, "correlation": pairs(*signs)})] == [
        "correlation.0.coefficient",
        "correlation.3.coefficient",
    ]


def test_every_entry_that_cannot_be_read_is_told_at_once():
    raw = {
        "vary": {"c_M": {"type": "triangl"}, "c_B": {"type": "normal", "deviaton": "5 %"}},
        "correlation": [{"between": ["k_1", "k_2"], "coefficient": 2}],
        "sampling": {"method": "sobol", "count": -1, "sed": 3},
    }
    assert {path for _, path, _ in found_in(raw)} == {
        "vary.c_M.type",
        "vary.c_B",
        "vary.c_B.deviaton",
        "correlation.0.coefficient",
        "sampling.count",
        "sampling.sed",
    }


def test_remarks_stop_nothing():
    [(severity, path, fault)] = found_in(changed(sampling={"method": "sobol", "count": 1000}))
    assert (severity, path) == ("warning", "sampling.count")
    assert is_as_expected(fault, "wrong-count: 1024")
    made, _ = read_space(changed(sampling={"method": "sobol", "count": 1000}), RIG)
    assert len(made.remarks) == 1


def test_bounds_of_a_parameter_are_what_is_plausible():
    shaft = tn.Drivetrain(
        "shaft",
        [tn.Inertia("disc", node="a", inertia=1), tn.Spring("s", nodes=("a", "ground"), stiffness="k")],
        parameters={"k": {"value": 100, "bounds": [90, 200]}},
    )
    [(severity, path, fault)] = found_in({"vary": {"k": {"type": "normal", "deviation": "10 %"}}}, shaft)
    assert (severity, path) == ("warning", "vary.k")
    assert is_as_expected(fault, "out-of-range: 16 % of k")
    [(_, _, fault)] = found_in({"vary": {"k": {"type": "list", "values": [80, 100, 230]}}}, shaft)
    assert is_as_expected(fault, "out-of-range: 80 and 230")


def test_a_share_too_small_to_meet_is_left_alone():
    # Below 0 are 8e-24 of the values at 10 %, 1e-9 at 16.7 % and 3e-7 at 20 %.
    assert found_in(changed(vary={"k_2": {"type": "normal", "deviation": "10 %"}})) == []
    [(_, _, fault)] = found_in(changed(vary={"k_2": {"type": "normal", "deviation": "20 %"}}))
    assert is_as_expected(fault, "out-of-range: 2.9e-05 % of k_2")
    assert found_in(changed(vary={"k_2": {"type": "normal", "deviation": "50 %", "low": 0}})) == []


def test_python_raises_them_all():
    with pytest.raises(ModelError) as caught:
        space({"k_9": Normal(deviation="5 %"), "k_2": Normal(deviation="60 %")})
    assert len(caught.value.faults) == 2
