"""Answers of studies on designs: closed forms of chains and dampers, on models with all that belongs to them."""

import json

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.machinery.design.level_minimax import ReceptanceLevels, WorstLevels
from torsionnet.study.design.best_damper import damper_over_conditions
from torsionnet.study.design.design_quantities import ExactSlopes
from torsionnet.study.design.optimise import polish
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.quantities.natural_frequency import DampingRatio, NaturalFrequency
from torsionnet.study.quantities.transfer_quantity import ResponseQuantity
from torsionnet.study.study import define

J_END = 0.5
F_1, F_2 = {"type": "natural_frequency", "mode": 1}, {"type": "natural_frequency", "mode": 2}
TOLERANCE = {"type": "normal", "deviation": "5 %"}


def chain(**more):
    return tn.Drivetrain(
        "chain",
        [
            *(tn.Inertia(node, node=node, inertia=J) for node, J in (("a", J_END), ("b", "J"), ("c", J_END))),
            tn.Spring("s", nodes=("a", "b"), stiffness="k", damping="c"),
            tn.Spring("t", nodes=("b", "c"), stiffness="k", damping="c"),
        ],
        parameters={"k": "1000 N*m/rad", "J": "1 kg*m^2", "c": "0.1 N*m*s/rad"},
        inputs={"T": {"torque": "a"}},
        sensors={"T_s": {"torque": "s"}},
        **more,
    )


def answered(answer, rig=None, *, vary=None, quantities=None, **more):
    study = define(
        rig or chain(),
        vary or {"k": TOLERANCE, "J": TOLERANCE},
        quantities or {"f_1": F_1, "f_2": F_2, "z_1": {"type": "damping_ratio", "mode": 1}},
        answers={"a": answer},
        **more,
    )
    found = study.answers["a"].conclude(study, None)
    assert isinstance(found.table().to_text(), str)
    assert json.loads(json.dumps(found.to_data()))["sentences"] == list(found.sentences)
    assert found.figure().axes
    return found


class TestOptimum:
    @pytest.mark.slow
    def test_two_targets_of_a_chain(self):
        """omega_1^2 = k/J_END and omega_2^2 = k (1/J_END + 2/J) without damping, c being small against it."""
        design = {"k": None, "J": ["0.02 kg*m^2", "10 kg*m^2"]}
        answer = {"type": "optimum", "design": design, "targets": {"f_1": "8 Hz", "f_2": {"value": "25 Hz"}}}
        found = answered(answer, chain().configured(c=0.0))
        k = J_END * (2 * np.pi * 8) ** 2
        assert found.values["k"] == pytest.approx(k, rel=1e-8)
        assert found.values["J"] == pytest.approx(2 / ((2 * np.pi * 25) ** 2 / k - 1 / J_END), rel=1e-8)
        assert "recomputed by a model with these values: the same" in found.sentences

    @pytest.mark.slow
    def test_in_two_configurations(self):
        """One stiffness for two chains with other ends: the relative deviations of k/J_END are balanced."""
        rig = chain(configurations={"load": {"light": {"J": 0.5}, "heavy": {"J": 2.0}}})
        answer = {"type": "optimum", "design": {"k": None}, "targets": {"f_2": "20 Hz"}}
        found = answered(answer, rig, vary={"k": TOLERANCE}, configurations="all")
        ones = np.sqrt(1 / J_END + 2 / np.array([0.5, 2.0])) / (2 * np.pi) / 20
        assert np.sqrt(found.values["k"]) == pytest.approx(
            ones.sum() / (ones**2).sum(), rel=1e-4
        )  # c moves them by 1e-5
        assert found.after["f_2"].shape == (2,)

    def test_what_varies_is_chosen_where_nothing_else_is_said(self):
        vary = {"k": {"type": "uniform", "low": "-20 %", "high": "+20 %"}}
        found = answered({"type": "optimum", "minimise": "f_1"}, vary=vary)
        assert found.values["k"] == pytest.approx(800)
        assert found.active_bounds == {"k": "lower"}

    @pytest.mark.slow
    def test_limits_of_the_study(self):
        answer = {"type": "optimum", "design": {"k": None}, "minimise": "f_1", "limits": {"f_2": {"above": "9 Hz"}}}
        found = answered(answer, limits={"f_1": {"above": "3 Hz"}})
        assert found.after["f_2"][0] == pytest.approx(9, rel=1e-6)
        assert "limits are kept; the optimum lies at the limit of f_2" in found.sentences

    @pytest.mark.parametrize(
        ("answer", "words"),
        [
            ({"type": "optimum"}, r"answers\.a: .*missing-entry"),
            ({"type": "optimum", "minimise": "f_1", "maximise": "f_2"}, "either minimise or maximise"),
            ({"type": "optimum", "minimise": "f_9"}, r"answers\.a\.minimise: .*unknown-name"),
            ({"type": "optimum", "targets": {"g": 1.0}}, "unknown-name"),
            ({"type": "optimum", "minimise": "f_1", "limits": {"g": {"below": 1}}}, "unknown-name"),
            ({"type": "optimum", "minimise": "f_1", "design": ["kk"]}, r"answers\.a\.design\.0: .*unknown-parameter"),
            (
                {"type": "optimum", "minimise": "f_1", "design": {"k": [200, 100]}},
                r"answers\.a\.design\.k: .*unordered-rows",
            ),
            (
                {"type": "optimum", "minimise": "f_1", "design": {"k": ["1 kg*m^2", 1e4]}},
                r"answers\.a\.design\.k\.bounds\.0: .*wrong-unit",
            ),
            ({"type": "optimum", "minimise": "f_1", "design": {"k": [1]}}, r"answers\.a\.design\.k: .*wrong-form"),
            ({"type": "best_damper", "output": "T_s"}, r"answers\.a: .*missing-entry"),
            ({"type": "best_damper", "output": "T_x", "design": ["c"]}, "T_x"),
            ({"type": "best_damper", "output": "T_s", "design": ["c"], "band": [1, 2]}, "needs an input"),
            ({"type": "pareto", "minimise": "f_1"}, r"answers\.a: .*missing-entry"),
            ({"type": "robust_optimum", "minimise": "f_1"}, r"answers\.a: .*missing-entry"),
            (
                {"type": "robust_optimum", "measure": "rejects", "design": ["k"]},
                r"answers\.a\.measure: .*missing-entry",
            ),
            ({"type": "robust_optimum", "minimise": "f_1", "design": ["k"], "percentile": 0.9}, "belongs to measure"),
        ],
    )
    def test_refusals(self, answer, words):
        with pytest.raises(tn.ModelError, match=words):
            answered(answer)


@pytest.mark.slow
def test_a_front_of_frequency_and_damping():
    """z = pi f c/k of a chain with c/k fixed by k: low f_1 and high z contradict each other; all on one line."""
    answer = {
        "type": "pareto",
        "design": {"k": [500, 2000]},
        "maximise": ["f_1", "z_1"],
        "population": 12,
        "generations": 8,
    }
    found = answered(answer)
    k = found.designs[:, 0]
    f = np.sqrt(k / J_END) / (2 * np.pi)
    np.testing.assert_allclose(found.values[:, 0], f, rtol=1e-4)
    np.testing.assert_allclose(found.values[:, 1], np.pi * f * 0.1 / k, rtol=1e-4)
    assert (k.min(), k.max()) == pytest.approx((500, 2000))


@pytest.mark.slow
def test_numbers_of_designs_have_their_units():
    k = {"k": [900, 1100]}
    limits = {"limits": {"f_2": {"below": 12}}}
    found = answered({"type": "optimum", "minimise": "f_1", "design": k})
    assert found.table().rows[1][:2] == ("f_1", "Hz")
    assert found.sentences[0].endswith(" Hz (minimised)")
    target = answered({"type": "optimum", "targets": {"f_1": 7}, "design": k})
    assert target.sentences[0] == "f_1 has its target, 7 Hz"
    front = answered(
        {"type": "pareto", "minimise": "f_1", "maximise": "f_2", "design": k, "population": 8, "generations": 1}
    )
    assert [one.unit for one in front.table().columns] == ["N*m/rad", "Hz", "Hz"]
    assert front.sentences[1].startswith("the best f_1 is ")
    assert front.sentences[1].count(" Hz") == 2
    robust = answered(
        {"type": "robust_optimum", "minimise": "f_1", "design": k, "samples": 32, "compared": 128, **limits}
    )
    units = {row[0]: row[1] for row in robust.table().rows}
    assert units["mean of f_1"] == units["mean + 3 sigma of f_1"] == units["mean + 3 sigma of f_2"] == "Hz"
    assert units["share that keeps all limits"] == ""
    assert any(said.startswith("on the samples it was chosen on, ") for said in robust.sentences)


@pytest.mark.slow
def test_a_robust_stiffness():
    """f_1 above 8 Hz in 97.5 %: k lognormal or nearly so around a value 1/(1 - 1.96 * 5 %) times as high."""
    answer = {
        "type": "robust_optimum",
        "design": {"k": None},
        "minimise": "f_1",
        "measure": "percentile",
        "percentile": "97.5 %",
        "samples": 256,
        "compared": 1024,
        "limits": {"f_1": {"above": "8 Hz"}},
    }
    found = answered(answer, vary={"k": TOLERANCE})
    k = J_END * (2 * np.pi * 8) ** 2
    assert found.nominal.values["k"] == pytest.approx(k, rel=1e-5)
    assert found.values["k"] == pytest.approx(k / (1 - 1.959964 * 0.05), rel=5e-3)
    low, high = found.designs[-1].share_kept[1:]
    assert low < 0.975 < high


J, K, MU = 2.0, 8e4, 0.2


def damped(**more):
    """A mass on a spring with a ring in a film, which may have a spring too."""
    return tn.Drivetrain(
        "damped",
        [
            tn.Inertia("mass", node="a", inertia=J),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness="K"),
            tn.ViscousDamper("damper", node="a", ring_inertia=MU * J, damping="c", stiffness="k_film"),
        ],
        parameters={"c": "50 N*m*s/rad", "k_film": f"{1.2 * MU * K} N*m/rad", "K": f"{K} N*m/rad"},
        **more,
    )


UNIFORM = {"type": "uniform", "low": "10 N*m*s/rad", "high": "500 N*m*s/rad"}
PEAK = {"peak": {"type": "peak", "output": "a", "input": "a", "band": ["5 Hz", "80 Hz"]}}


@pytest.mark.slow
def test_houdaille_damper():
    """J. P. Den Hartog: 1 + 2/mu, at c/(2 J_ring omega_1) = 1/sqrt(2 (1 + mu) (2 + mu))."""
    answer = {"type": "optimum", "design": {"c": ["10 N*m*s/rad", "500 N*m*s/rad"]}, "minimise": "peak"}
    found = answered(answer, damped().configured(k_film=0.0), vary={"c": TOLERANCE}, quantities=PEAK)
    assert found.merit * K == pytest.approx(1 + 2 / MU, rel=1e-9)
    assert found.values["c"] / (2 * MU * J * np.sqrt(K / J)) == pytest.approx(
        1 / np.sqrt(2 * (1 + MU) * (2 + MU)), rel=1e-5
    )


@pytest.mark.slow
def test_tuned_damper():
    """O. Nishihara and T. Asami, J. Vib. Acoust. 124 (2002) 576: the exact minimax."""
    answer = {"type": "optimum", "design": {"c": [10, 100], "k_film": [6000, 30000]}, "minimise": "peak"}
    found = answered(answer, damped(), vary={"c": TOLERANCE}, quantities=PEAK)
    root = np.sqrt(4 + 3 * MU)
    square = 2 * (16 + 23 * MU + 9 * MU**2 + 2 * (2 + MU) * root) / (3 * (64 + 80 * MU + 27 * MU**2))
    own = 2 / (1 + MU) * np.sqrt(square) * np.sqrt(K / J)
    zeta = np.sqrt((8 + 9 * MU - 4 * root) / (1 + MU)) / 4
    assert found.values["k_film"] == pytest.approx(MU * J * own**2, rel=1e-6)
    assert found.values["c"] == pytest.approx(2 * MU * J * zeta * own, rel=1e-5)
    assert found.merit * K == pytest.approx(np.sqrt(1 + 2 / MU), rel=0.005)  # Den Hartog's fixed points


DAMPER = {"c": [10, 100], "k_film": [6000, 30000]}


def near(quantities, place=(0.6, 0.4), **answer):
    """Values that a search from one place comes to."""
    given = {"a": {"type": "optimum", "design": DAMPER, **answer}}
    study = define(damped(), {"c": TOLERANCE}, {**PEAK, **quantities}, answers=given)
    problem, _ = study.answers["a"].problem(study)
    return problem.values(polish(problem, np.array(place)))


class TestPeaksThatChangePlace:
    """Two peaks are equal at the best damper: the largest of them has a kink there, whatever is limited besides."""

    @pytest.mark.slow
    def test_a_limit_that_does_not_hold(self):
        static = {"low": {"type": "response", "output": "a", "input": "a", "at": "5 Hz"}}
        found = near(static, place=(0.55, 0.39), minimise="peak", limits={"low": {"below": 1.0}})
        root = np.sqrt(4 + 3 * MU)  # O. Nishihara and T. Asami, as above
        square = 2 * (16 + 23 * MU + 9 * MU**2 + 2 * (2 + MU) * root) / (3 * (64 + 80 * MU + 27 * MU**2))
        own = 2 / (1 + MU) * np.sqrt(square) * np.sqrt(K / J)
        assert found["k_film"] == pytest.approx(MU * J * own**2, rel=1e-6)
        assert found["c"] == pytest.approx(MU * J * own * np.sqrt((8 + 9 * MU - 4 * root) / (1 + MU)) / 2, rel=1e-5)

    @pytest.mark.slow
    def test_a_limit_of_both_peaks(self):
        """The film that takes least out of a slow motion, its peaks at most 3.6/K: both are as high as that.

        From the magnification in closed form: the layer at which the smallest damping keeps both peaks.
        """
        f = 2 * np.pi * np.linspace(15, 50, 4001)

        def peak(c, k):
            law = k + 1j * f * c
            ring = law - MU * J * f**2
            return np.abs(ring / ((K - J * f**2 + law) * ring - law**2)).max()

        def lowest(c):
            return scipy.optimize.minimize_scalar(
                lambda k: peak(c, k), bounds=(9e3, 14e3), method="bounded", options={"xatol": 1e-2}
            )

        c = scipy.optimize.brentq(lambda c: lowest(c).fun - 3.6 / K, 20, 30, xtol=1e-4)
        lag = {"lag": {"type": "response", "output": "a", "input": "a", "at": "12 Hz", "part": "imaginary"}}
        found = near(lag, maximise="lag", limits={"peak": {"below": 3.6 / K}})
        assert found == {"c": pytest.approx(c, rel=1e-5), "k_film": pytest.approx(lowest(c).x, rel=1e-5)}

    def test_where_a_torque_follows_another_motion(self):
        """There are no exact derivatives then: the differences are those of a damper that does the same."""
        brake = tn.Controller("brake", sense={"velocity": "a"}, act="a", law={"p": -20})
        damper = tn.Damper("brake", nodes=("a", "ground"), damping=20.0)
        slopes = []
        for one in (brake, damper):
            rig = tn.Drivetrain("damped", [*damped().elements.values(), one], parameters=damped().definition.parameters)
            answers = {"a": {"type": "optimum", "design": DAMPER, "minimise": "peak"}}
            study = define(rig, {"c": TOLERANCE}, PEAK, answers=answers)
            slopes.append(study.answers["a"].problem(study)[0].jacobian(np.array([0.3, 0.2]))["peak"])
        np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-6)


STIFF = 1.5


@pytest.fixture(scope="module")
def film():
    """For a soft and a stiff shaft."""
    rig = damped(configurations={"shaft": {"soft": {"K": K}, "stiff": {"K": STIFF * K}}}).configured(k_film=0.0)
    return damper_over_conditions(rig, "a", {"c": (20.0, 400.0)}, input="a", band=(5.0, 80.0))


class TestDamperOverConditions:
    """One film for a soft and a stiff shaft, against the magnification in closed form on a lattice of films."""

    def level(self, stiffness, films):
        omega = 2 * np.pi * np.linspace(15, 50, 7001)[:, None]
        law = 1j * omega * films
        ring = -MU * J * omega**2 + law
        return np.abs(ring / ((stiffness - J * omega**2 + law) * ring - law**2)).max(axis=0)

    @pytest.mark.slow
    def test_worst_of_both(self, film):
        films = np.linspace(20, 400, 761)
        worst = np.maximum(self.level(K, films), self.level(STIFF * K, films))
        assert film.values["c"] == pytest.approx(films[np.argmin(worst)], abs=0.6)
        assert film.worst.after.level == pytest.approx(worst.min(), rel=1e-4)
        for one, stiffness in zip(film.conditions, (K, STIFF * K), strict=True):
            assert one.after.level == pytest.approx(self.level(stiffness, film.values["c"])[0], rel=1e-5)
            assert one.alone.level == pytest.approx((1 + 2 / MU) / stiffness, rel=1e-6)

    def test_words(self, film):
        assert film.holding == ("soft",)
        assert film.sentences[0].startswith("the largest a/a of all conditions goes from")
        assert [row[0] for row in film.table().rows] == ["soft", "stiff"]
        assert json.loads(json.dumps(film.to_data()))["values"] == film.values

    def test_in_a_study(self, film, monkeypatch):
        """It asks what was asked for the film above, whose search it hands on."""
        asked = {}

        def searched(_, output, design, conditions, **more):
            asked.update(output=output, design=design, conditions=conditions, **more)
            return film

        monkeypatch.setattr("torsionnet.study.design.best_damper.damper_over_conditions", searched)
        rig = damped(configurations={"shaft": {"soft": {"K": K}, "stiff": {"K": STIFF * K}}}).configured(k_film=0.0)
        answer = {"type": "best_damper", "design": {"c": [20, 400]}, "output": "a", "input": "a", "band": "5..80 Hz"}
        found = answered(answer, rig, vary={"c": TOLERANCE}, quantities=PEAK, configurations="all")
        assert found is film
        assert callable(asked.pop("kept"))
        assert asked == {
            "output": "a", "input": "a", "design": {"c": (20.0, 400.0)}, "conditions": ("soft", "stiff"),
            "band": (5.0, 80.0), "excitation": None,
        }  # fmt: skip

    @pytest.mark.slow
    def test_what_varies_is_chosen_where_nothing_else_is_said(self):
        """J. P. Den Hartog: 1 + 2/mu, as above; a model without configurations has no conditions to name."""
        answer, vary = {"type": "best_damper", "output": "a", "input": "a", "band": "5..80 Hz"}, {"c": UNIFORM}
        found = answered(answer, damped().configured(k_film=0.0), vary=vary, quantities=PEAK)
        closed = 2 * MU * J * np.sqrt(K / J) / np.sqrt(2 * (1 + MU) * (2 + MU))
        assert found.values == {"c": pytest.approx(closed, rel=1e-5)}
        assert found.worst.after.level == pytest.approx((1 + 2 / MU) / K, rel=1e-8)
        assert not any("()" in one for one in found.sentences)

    def test_refusals(self):
        with pytest.raises(tn.UsageError, match="has no configurations"):
            damper_over_conditions(damped(), "a", "c", input="a")
        with pytest.raises(tn.UsageError, match="missing-entry"):
            damper_over_conditions(damped(), "a", [], ["soft"], input="a")


def test_levels_of_several_conditions_are_those_of_each():
    rigs = [damped().configured(K=stiffness) for stiffness in (K, STIFF * K)]
    parts = tuple(
        ReceptanceLevels(parametric_response(rig, "a", "a", [1.0], ["c", "k_film"]), (5.0, high))
        for rig, high in zip(rigs, (60.0, 80.0), strict=True)
    )
    worst, values = WorstLevels(parts, 80.0), np.array([40.0, 15000.0])
    points = np.array([12.0, 30.0, 160.0 + 12.0, 160.0 + 75.0])
    np.testing.assert_array_equal(worst.condition(points), [0, 0, 1, 1])
    np.testing.assert_allclose(worst.shown(points), [12, 30, 12, 75])
    for function in ("sizes_at", "slopes"):
        each = [
            getattr(part, function)(values, points[2 * place : 2 * place + 2] - 160 * place)
            for place, part in enumerate(parts)
        ]
        np.testing.assert_allclose(getattr(worst, function)(values, points), np.concatenate(each), rtol=1e-12)
    maxima = worst.maxima(values)
    assert (np.diff(worst.sizes_at(values, maxima)) <= 0).all()
    expected = np.sort(np.concatenate([part.maxima(values) for part in parts]))
    np.testing.assert_allclose(np.sort(worst.shown(maxima)), expected, rtol=1e-9)


def test_exact_slopes():
    """Against central differences of the quantities themselves."""
    rig = tn.load("amt_rig").configured("III")
    names = ("k_1", "c_1", "k_2")
    asked = {
        "f": NaturalFrequency(mode=1),
        "damped": NaturalFrequency(mode=2, which="damped"),
        "zeta": DampingRatio(mode=1),
        **{
            part: ResponseQuantity(output="theta_1", input="T_T", at=["5 Hz", "12 Hz"], part=part)
            for part in ("magnitude", "phase", "real", "imaginary", "dB")
        },
    }
    evaluator = Evaluator(rig, names, asked)
    given = {name: rig.parameters[name] for name in names}
    found = ExactSlopes(evaluator, tuple(asked))(given)
    assert set(found) == set(asked)
    for place, name in enumerate(names):
        step = 1e-4 * given[name]
        ends = {other: np.full(2, value) for other, value in given.items()}
        ends[name] = given[name] + step * np.array([-1.0, 1.0])
        for quantity, values in evaluator(ends).items():
            change = np.diff(values, axis=0).ravel() / (2 * step)
            scale = np.abs(found[quantity] * list(given.values())).max() / given[name]
            np.testing.assert_allclose(found[quantity][:, place], change, rtol=1e-5, atol=1e-7 * scale)


def test_undamped_frequencies_have_numerical_slopes():
    evaluator = Evaluator(chain(), ("k",), {"f": NaturalFrequency(mode=1, which="undamped")})
    assert ExactSlopes(evaluator, ("f",))({"k": 1000.0}) == {}
