"""Which value, freed alone, explains a misfit."""

import json
import re
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from support import campaigns
from support.command_line import run

import torsionnet as tn
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.identification import causes as cause_fits
from torsionnet.identification import fitting, load_fit, rank_causes
from torsionnet.identification.causes import Cause
from torsionnet.identification.fit_problem import make_problem
from torsionnet.identification.fit_search import local_optimum
from torsionnet.identification.fitting import _promising as promising
from torsionnet.identification.plan.fit_entries import Unknown
from torsionnet.io import read_frequency_response

F = np.array([6.0, 14.0, 24.0])
YAML = """\
torsionnet: 1
name: geared rig
parameters: {J_M: 0.05, J_L: 0.6, k_1: 2 kN*m/rad, k_2: 9 kN*m/rad, d: 0.4, tau: 3}
elements:
  motor:  {type: inertia, node: a, inertia: J_M}
  shaft:  {type: spring, nodes: [a, b], stiffness: k_1}
  stage:  {type: gear, nodes: [b, c], RATIO}
  output: {type: spring, nodes: [c, d], stiffness: k_2}
  load:   {type: inertia, node: d, inertia: J_L}
  drag:   {type: damper, nodes: [d, ground], damping: d}
inputs: {T: {torque: a}}
sensors: {n_out: {velocity: d}}
"""


def rig(ratio="ratio: tau", **parameters):
    return tn.loads(YAML.replace("RATIO", ratio)).configured(**parameters)


def curve(path, ratio):
    """Magnitudes at three frequencies, to three digits, as from a published figure."""
    sizes = rig(tau=ratio).frequency_response("n_out", "T", F).magnitude[:, 0, 0]
    rows = [f"{f},{size:.3g}" for f, size in zip(F, sizes, strict=True)]
    path.write_text("\n".join(["frequency [Hz],|n_out/T| [rad/s/(N*m)]", *rows, ""]))
    return tn.Measurement(read_frequency_response(path), "n_out", "T", error=0.02, name="figure")


@pytest.fixture(scope="module")
def figure(tmp_path_factory):
    """Of a rig whose ratio is 3 / 1.29."""
    return curve(tmp_path_factory.mktemp("figure") / "figure.csv", 3 / 1.29)


@pytest.fixture(scope="module")
def ranked(figure):
    """The ranking for a gear written in some way, made once."""
    return cache(lambda ratio: rank_causes(rig(ratio), figure))


@pytest.fixture(scope="module")
def fit(figure):
    """Of the drag, which makes up for nothing."""
    return tn.identify(rig(), figure, ["d"])


UNDAMPED = """\
torsionnet: 1
parameters: {c: 0}
elements:
  rotor: {type: inertia, node: a, inertia: 2}
  shaft: {type: spring, nodes: [a, ground], stiffness: 5 kN*m/rad, damping: c}
inputs: {T: {torque: a}}
sensors: {phi: {angle: a}}
"""


def test_a_value_that_is_zero_in_the_model_is_searched_to_the_end():
    """Its search begins with tiny steps, which change next to nothing."""
    model = tn.loads(UNDAMPED)
    test = model.configured(c=8.0).frequency_response("phi", "T", np.linspace(6, 10, 9))
    ranking = rank_causes(model, tn.Measurement(test, "phi", "T", error=0.01))
    (damping,) = (one for one in ranking.causes if one.unknown == "c")
    assert damping.value == pytest.approx(8, rel=1e-4)
    assert damping.explains


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "name"),
    [
        ("ratio: tau", "tau"),
        pytest.param("ratio: 3", "stage.ratio", marks=pytest.mark.nightly),
        ("teeth: [20, 60]", "stage.ratio"),
    ],
)
def test_a_wrong_ratio_is_named_and_stiffnesses_are_ruled_out(ranked, ratio, name):
    """Magnitudes at three frequencies only, and nothing free."""
    ranking = ranked(ratio)
    found = {one.unknown: one for one in ranking.causes}
    assert {"k_1", "k_2", "J_M", "J_L", "d", "gain", name} <= found.keys()
    assert ranking.causes[0].unknown in (name, "gain")
    assert found[name].explains
    assert found[name].value == pytest.approx(3 / 1.29, rel=0.01)
    assert found[name].before == 3
    assert not found["k_1"].explains
    assert not found["k_2"].explains
    assert re.search(rf"^only .*{name} = 2\.3\d* instead of 3", ranking.verdict)
    assert "k_1" not in ranking.verdict


@pytest.mark.slow
def test_a_calibration_error_is_named_too(tmp_path):
    """All magnitudes 29 % high: what a gain undoes to rounding, no stiffness does."""
    figure = curve(tmp_path / "figure.csv", 3.0)
    loud = replace(figure, data=replace(figure.data, values=1.29 * figure.data.values))
    ranking = rank_causes(rig(), loud)
    best = ranking.causes[0]
    assert (best.kind, best.of, best.explains) == ("gain", "n_out", True)
    assert best.value == pytest.approx(1.29, rel=0.005)
    assert best.misfit < 0.005
    assert ranking.misfit > 0.2
    assert not any(one.explains for one in ranking.causes if one.unknown.startswith("k_"))


@pytest.mark.slow
@pytest.mark.parametrize("of", ["model and test", pytest.param("fit", marks=pytest.mark.slow)])
def test_parameters_are_fitted_along(of):
    """A free drag does not make up for a wrong inertia; a fit has its own parameters."""
    f = np.linspace(3, 20, 30)
    test = tn.Measurement(rig(J_L=0.8, d=0.7).frequency_response("n_out", "T", f), "n_out", "T")
    ranking = rank_causes(tn.identify(rig(), test, ["d"])) if of == "fit" else rank_causes(rig(), test, ["d"])
    best = ranking.causes[0]
    assert (best.unknown, best.explains) == ("J_L", True)
    assert best.value == pytest.approx(0.8, rel=1e-6)
    assert "d" not in [one.unknown for one in ranking.causes]


@pytest.mark.slow
def test_a_fit_of_three_magnitudes_names_the_ratio(figure, fit):
    """By the error stated, which alone says what noise there is."""
    assert fit.lack_of_fit.rejected
    assert [one.unknown for one in fit.lack_of_fit.explanations] == ["tau"]
    assert "tau = 2.325 instead of 3 would explain it" in fit.verdicts[0]
    right = tn.identify(rig(tau=3 / 1.29), figure, ["d"])
    assert not right.lack_of_fit.rejected


def test_table(ranked):
    table = ranked("ratio: tau").table()
    assert [column.name for column in table.columns][:3] == ["freed alone", "model has", "would be"]
    assert {row[-1] for row in table.rows} == {"yes", "no"}
    assert table.notes[0].startswith("only ")


@pytest.mark.slow
def test_nothing_to_compare_with(tmp_path, fit):
    with pytest.raises(UsageError, match="nothing measured"):
        rank_causes(rig())
    fit.to_yaml(tmp_path / "fit.yaml")
    with pytest.raises(UsageError, match="read from a file"):
        rank_causes(load_fit(tmp_path / "fit.yaml"))


def command_files(folder, monkeypatch):
    monkeypatch.chdir(folder)
    curve(folder / "figure.csv", 3 / 1.29)
    (folder / "rig.yaml").write_text(YAML.replace("RATIO", "ratio: tau"))
    (folder / "fit.yaml").write_text(
        "torsionnet: 1\nmodel: rig.yaml\nparameters: {d: 0.5}\n"
        "measurements: {figure: {response: figure.csv, output: n_out, input: T, error: 2 %}}\n"
    )


@pytest.mark.slow
def test_command(tmp_path, monkeypatch):
    """The model does not fit by the error stated; what would explain it is told with a table."""
    command_files(tmp_path, monkeypatch)
    result = run("fit", "fit.yaml", "--rank")
    assert "What would explain the misfit" in result.stdout
    assert re.search(r"tau +3 +2\.3\d* .*yes", result.stdout)
    assert re.search(r"k_1 .*no", result.stdout)
    assert "the model does not fit" in result.stderr


@pytest.mark.nightly
def test_command_in_json(tmp_path, monkeypatch):
    command_files(tmp_path, monkeypatch)
    ranking = json.loads(run("fit", "fit.yaml", "--rank", "--json").stdout)["ranking"]
    assert {one["unknown"]: one["explains"] for one in ranking}["k_2"] is False


# Channels that are reversed, and one rule for what explains


def reversed_test(noise=0.01, **more):
    """A torque meter mounted the wrong way round."""
    response = rig().frequency_response("n_out", "T", np.linspace(3, 20, 25))
    rng = np.random.default_rng(2)
    error = noise * (rng.normal(size=response.values.shape) + 1j * rng.normal(size=response.values.shape))
    return tn.Measurement(replace(response, values=-response.values * (1 + error)), "n_out", "T", **more)


@pytest.mark.parametrize("residual", ["complex", "log"])
def test_a_reversed_channel_is_found_along(residual):
    fit = tn.identify(rig(k_2=7000), reversed_test(gain=True), ["k_2"], residual=residual)
    assert fit.values["k_2"] == pytest.approx(9000, rel=0.01)
    assert fit.values["gain[measurement]"] == pytest.approx(-1, abs=0.01)
    low, high = fit.intervals()["gain[measurement]"]
    assert low < -1 < high
    assert fit.verdicts == ()


def test_a_gain_is_tried_both_ways():
    problem = make_problem(rig(), [reversed_test()], {"d": Unknown()}, "complex")
    gain = Cause("gain", "gain")

    def solve(tried, start, tolerance=1e-12):
        return local_optimum(tried, start, "linear", tolerance)

    (found,) = cause_fits.fit_causes(problem, [gain], [problem.start], solve, np.inf)
    assert dict(zip(found.problem.names, found.values, strict=True))["gain[measurement]"] == pytest.approx(-1, abs=0.01)
    assert cause_fits.explaining_fits([found], cause_fits.sum_of_squares(problem, problem.start)) == [found]


@pytest.mark.parametrize(("kind", "unknown", "factors"), [("value", "k_2", [1, 0.5, 2]), ("delay", "delay", [1])])
def test_values_of_the_model_are_searched_from_several_starts(kind, unknown, factors):
    problem, begun = make_problem(rig(), [reversed_test()], {"d": Unknown()}, "complex"), []

    def solve(tried, start, tolerance=1e-12):
        del tolerance
        names = [name.partition("[")[0] for name in tried.names]
        begun.append(start[names.index(unknown)] / (tried.start[names.index(unknown)] or 1))
        return SimpleNamespace(x=start)

    cause_fits.fit_causes(problem, [Cause(kind, unknown)], [problem.start], solve, 0.0)
    assert len(begun) == len(factors)
    assert kind != "value" or begun == pytest.approx(factors)


@pytest.mark.slow
def test_a_reversed_channel_is_named_by_fit_and_ranking():
    ranking = rank_causes(rig(), reversed_test())
    assert (ranking.causes[0].kind, ranking.causes[0].explains) == ("gain", True)
    assert ranking.causes[0].value == pytest.approx(-1, abs=0.01)
    assert re.fullmatch(
        r"only a gain of -(1|0\.99\d*|1\.00\d*) in n_out \(a channel is reversed\) explains the misfit", ranking.verdict
    )
    fit = tn.identify(rig(), reversed_test(), ["d"])
    assert "in n_out (a channel is reversed) would explain it" in fit.verdicts[0]


@pytest.mark.slow
@pytest.mark.parametrize("free", ["c", pytest.param("k", marks=pytest.mark.nightly)])
def test_ranking_and_verdict_come_from_one_search(free):
    """A wrong model leads the fit far off, from where the ranking alone came to other gains, or to none."""
    from benchmarks.interval_coverage import noisy_response, one_mass

    data = noisy_response("relative", 0.01, 0, np.linspace(1, 60, 60))
    test, model = tn.Measurement(replace(data, values=-data.values), "theta", "T"), one_mass(c=0.3)
    fit = tn.identify(model, test, ["c", free])
    (named,) = (one for one in fit.lack_of_fit.explanations if one.kind == "gain")
    for ranking in (rank_causes(fit), rank_causes(model, test, ["c", free])):
        (ranked,) = (one for one in ranking.causes if one.kind == "gain")
        assert ranked.explains
        assert ranked.value == pytest.approx(named.values["gain[measurement]"], rel=1e-5)
        assert ranked.value == pytest.approx(-1, abs=0.01)
        assert ranked.misfit < 0.02


def test_magnitudes_do_not_tell_a_reversed_channel():
    fit = tn.identify(rig(), reversed_test(gain=True), ["k_2"], residual="magnitude")
    assert fit.values["gain[measurement]"] == pytest.approx(1, abs=0.01)


def test_what_cannot_be_judged_is_told_in_words(monkeypatch):
    def fails(*_):
        raise np.linalg.LinAlgError("SVD did not converge")

    monkeypatch.setattr(fitting, "misfits", fails)
    with pytest.raises(SolveError, match="no-solution"):
        tn.identify(rig(), reversed_test(), ["k_2"])


def gears(count):
    """Second to fifth gear of the AMT, whose ratio is another one in each."""
    true, rng, tests = tn.load("amt_rig"), np.random.default_rng(1), []
    for gear in ("II", "III", "IV", "V"):
        response = true.configured(gear).frequency_response("theta_1", "T_T", np.linspace(1, 20, count))
        error = 0.005 * (rng.normal(size=response.values.shape) + 1j * rng.normal(size=response.values.shape))
        data = replace(response, values=response.values * (1 + error))
        tests.append(tn.Measurement(data, "theta_1", "T_T", configuration=gear))
    return true.configured(c_B=0.001), tests


def test_causes_are_weighed_where_each_configuration_stands():
    """A linear estimate at the ratio of second gear for all called the bearing's damping hopeless."""
    model, tests = gears(15)
    problem = make_problem(model, tests, {"c_O": Unknown()}, "complex")
    assert "c_B" in [cause.unknown for cause in promising(problem, np.array([211.0]))[:3]]


@pytest.mark.slow
def test_verdict_of_a_fit_and_ranking_agree():
    model, tests = gears(36)
    fit = tn.identify(model, tests, ["c_O"])
    (named,) = re.findall(r"; (c_B = 1\.49\d instead of 0\.001) would explain it: c_O would be 170", fit.verdicts[0])
    for ranked in ((fit,), (model, tests, ["c_O"]))[: campaigns.examples(1, 2)]:
        assert rank_causes(*ranked).verdict == f"only {named} explains the misfit"


@pytest.mark.parametrize(
    ("misfits", "squares", "error", "explain"),
    [
        ((4.8, 8.4), (1.0, 3.06), None, 1),
        ((4.8, 8.4), (1.0, 1.2), None, 1),
        ((4.8, 5.2), (1.0, 1.2), None, 2),
        ((0.01, 0.5), (1e-4, 2.0), 0.02, 2),
        ((0.01, 4.0), (1e-4, 9.0), 0.02, 1),
        ((4.8, 5.2), (30.0, 31.0), None, 0),
    ],
)
def test_what_explains_beside_the_best(monkeypatch, misfits, squares, error, explain):
    """As of a measured thruster rig, where one value left 4.8 % and another, a hundredth of what it is, 8.4 %."""
    monkeypatch.setattr(cause_fits, "overall_misfit", lambda problem, _: problem.misfit)
    blocks = [SimpleNamespace(noise_is_stated=error is not None)]
    tried = [
        cause_fits.CauseFit(
            Cause("value", "k"),
            SimpleNamespace(blocks=blocks, effective_count=6.0, names=("k",), start=np.array([2.0]), misfit=misfit),
            np.array([3.0]),
            left,
        )
        for misfit, left in zip(misfits, squares, strict=True)
    ]
    assert len(cause_fits.explaining_fits(tried, 100.0)) == explain


def test_a_value_that_runs_away_explains_nothing():
    problem = SimpleNamespace(names=("k",), start=np.array([2.0]))
    assert cause_fits.CauseFit(Cause("value", "k"), problem, np.array([1.9e9]), 0.0).ended
    assert not cause_fits.CauseFit(Cause("gain", "k"), problem, np.array([-2.0]), 0.0).ended


BEARING = """torsionnet: 1
name: two masses, one on a bearing
parameters: {c: 2 N*m*s/rad}
elements:
  first: {type: inertia, node: a, inertia: 0.5}
  second: {type: inertia, node: b, inertia: 0.8}
  shaft: {type: spring, nodes: [a, b], stiffness: 6000, damping: 1.5}
  bearing: {type: damper, nodes: [b, ground], damping: c}
"""


def test_what_is_rounding_is_said_to_be_zero():
    """A test without friction, and one that the model fits but for rounding."""
    rig = tn.loads(BEARING)
    free = rig.configured(c=0).frequency_response("b", "a", np.linspace(2, 40, 60))
    ranking = rank_causes(rig, tn.Measurement(free, "b", "a"))
    first = ranking.causes[0]
    assert (first.unknown, first.value, first.explains) == ("c", 0.0, True)
    assert ranking.verdict == "only c = 0 instead of 2 explains the misfit"
    own = rank_causes(rig, tn.Measurement(rig.frequency_response("b", "a", np.linspace(2, 40, 60)), "b", "a"))
    assert own.misfit == 0
    assert not any(one.explains for one in own.causes)
    assert own.verdict == "the model fits but for rounding: there is no misfit to explain"
    assert {one.misfit for one in own.causes if one.value in (0, one.before)} == {0}
