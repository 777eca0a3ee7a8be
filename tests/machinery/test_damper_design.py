"""Optimum dampers against closed forms: Den Hartog's untuned and tuned dampers, the exact minimax of the tuned one."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from support.command_line import run

import torsionnet as tn
from torsionnet import plot
from torsionnet.linear.frequency_response import Channel
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.machinery.design.damper_optimum import DamperOptimum, DesignParameter, FixedPoint, LevelPeak
from torsionnet.machinery.design.level_minimax import OrderLevels, ReceptanceLevels, VariedModel, largest

J, K = 2.0, 8e4
OMEGA = np.sqrt(K / J)


def untuned(mu, damping=100.0, **more):
    """A mass on a spring with a ring in a film."""
    return tn.Drivetrain(
        "untuned",
        [
            tn.Inertia("mass", node="a", inertia=J),
            tn.Spring("shaft", nodes=("a", "ground"), stiffness=K),
            tn.ViscousDamper("damper", node="a", ring_inertia=mu * J, damping="c", stiffness="k_film"),
        ],
        parameters={"c": f"{damping} N*m*s/rad", "k_film": "0 N*m/rad"},
        **more,
    )


def running(mu, **more):
    """The same under a torque of 5 N m once a revolution."""
    return untuned(
        mu,
        speeds={"of": "a", "range": "1000..2200 rpm", "step": "3 rpm"},
        excitations={"unbalance": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "5 N*m"}}}},
        **more,
    )


@pytest.mark.parametrize(
    ("mu", "zeta", "peak", "ratio"),
    [
        pytest.param(0.2, 0.43519, 11, 0.95346, marks=pytest.mark.nightly),
        (0.5, 0.36515, 5, 0.89443),
        pytest.param(1, 0.28868, 3, 0.81650, marks=pytest.mark.nightly),
    ],
)
class TestHoudaille:
    """Numbers of Den Hartog's chapter 3, zeta = c/(2 J_ring omega_1)."""

    @pytest.mark.slow
    def test_best_film(self, mu, zeta, peak, ratio):
        found = untuned(mu).damper_design("a", "c", input="a")
        assert found.values["c"] / (2 * mu * J * OMEGA) == pytest.approx(zeta, abs=2e-5)
        assert found.after.level * K == pytest.approx(peak, rel=1e-9)
        assert found.after.point * 2 * np.pi / OMEGA == pytest.approx(ratio, abs=1e-5)
        (point,) = found.fixed_points
        assert point.point * 2 * np.pi / OMEGA == pytest.approx(np.sqrt(2 / (2 + mu)), rel=1e-9)
        assert point.spread < 1e-9
        assert "c is an optimum inside its bounds" in found.words
        assert found.words[-1].endswith("none has a smaller maximum")

    def test_over_speed(self, mu, zeta, peak, ratio):
        """One order of constant torque asks the same question; its speeds are steps, so that the answer is coarser."""
        found = running(mu).damper_design("a", {"c": ("20 N*m*s/rad", 2000)})
        assert found.values["c"] / (2 * mu * J * OMEGA) == pytest.approx(zeta, rel=0.01)
        assert found.after.level * K / 5 == pytest.approx(peak, rel=1e-3)
        assert found.after.point * np.pi / 30 / OMEGA == pytest.approx(ratio, abs=0.01)
        assert found.of == ("speed of a", "r/min")
        assert not found.fixed_points


@pytest.fixture(scope="module")
def found(mu):
    """The best tuning of a ring with a spring, beginning elsewhere."""
    plant = untuned(mu, damping=0.2 * 2 * mu * J * OMEGA)
    return plant.configured(k_film=1.3 * mu * K).damper_design("a", {"c": None, "k_film": None}, input="a")


@pytest.mark.parametrize("mu", [pytest.param(0.05, marks=pytest.mark.nightly), 0.2], scope="module")
class TestTunedMass:
    """A ring with a spring on an undamped primary mass under a torque."""

    def tuning(self, mu, found):
        """Frequency of the ring over that of the primary mass, and its own damping ratio."""
        own = np.sqrt(found.values["k_film"] / (mu * J))
        return own / OMEGA, found.values["c"] / (2 * mu * J * own)

    @pytest.mark.slow
    def test_exact_minimax(self, mu, found):
        """O. Nishihara and T. Asami, J. Vib. Acoust. 124 (2002) 576: closed forms of both values."""
        root = np.sqrt(4 + 3 * mu)
        f, zeta = self.tuning(mu, found)
        square = 2 * (16 + 23 * mu + 9 * mu**2 + 2 * (2 + mu) * root) / (3 * (64 + 80 * mu + 27 * mu**2))
        assert f == pytest.approx(2 / (1 + mu) * np.sqrt(square), rel=1e-5)
        assert zeta == pytest.approx(np.sqrt((8 + 9 * mu - 4 * root) / (1 + mu)) / 4, rel=1e-4)

    @pytest.mark.slow
    def test_den_hartog_and_brock(self, mu, found):
        """f = 1/(1 + mu), and c/(2 J_ring omega_1) = sqrt(3 mu/(8 (1 + mu)^3)), both good to a percent."""
        f, zeta = self.tuning(mu, found)
        assert f == pytest.approx(1 / (1 + mu), rel=1e-3)
        assert zeta * f == pytest.approx(np.sqrt(3 * mu / (8 * (1 + mu) ** 3)), rel=0.01)
        assert found.after.level * K == pytest.approx(np.sqrt(1 + 2 / mu), rel=0.005)

    def test_two_peaks_are_equal(self, found):
        low, high = sorted(found.peaks, key=lambda peak: peak.point)
        assert low.level == pytest.approx(high.level, rel=1e-7)
        assert low.point < OMEGA / (2 * np.pi) < high.point
        assert len(found.fixed_points) == 2


class TestLevels:
    def test_slopes_of_a_receptance(self):
        plant = untuned(0.5)
        response = parametric_response(plant, "a", "a", [1.0], ["c", "k_film"])
        self.check(ReceptanceLevels(response, (5.0, 60.0)), np.array([120.0, 900.0]), np.array([12.0, 28.0, 40.0]))

    def test_slopes_over_speed(self):
        plant = running(0.5)
        response = parametric_response(plant, "a", "a", [1.0], ["c", "k_film"])
        levels = OrderLevels(VariedModel(response.unknowns), "a", None, plant.order_response("a"))
        self.check(levels, np.array([120.0, 900.0]), np.array([80.0, 180.0, 210.0]))

    @staticmethod
    def check(levels, values, points):
        slopes = levels.slopes(values, points)
        for place in range(2):
            step = np.where(np.arange(2) == place, 1e-3 * values, 0)
            change = levels.sizes_at(values + step, points) - levels.sizes_at(values - step, points)
            np.testing.assert_allclose(slopes[:, place], change / (2 * step[place]), rtol=1e-4)


@pytest.mark.slow
def test_a_bound_that_holds_is_said():
    found = untuned(0.5).damper_design("a", {"c": (10, 100)}, input="a")
    assert found.values["c"] == pytest.approx(100)
    assert found.parameters[0].bound == "upper"
    assert "c is at its upper bound; beyond it the maximum may be smaller still" in found.words
    lower = untuned(0.5).damper_design("a", {"c": (800, 2000)}, input="a").parameters[0]
    assert (lower.value, lower.bound) == (pytest.approx(800), "lower")


def test_a_value_without_effect_is_said():
    """Far from the resonance, at which even so little damping decides."""
    found = running(0.5).damper_design("a", {"c": (1e-6, 2e-6)}, speeds=np.linspace(1000, 1100, 11) * np.pi / 30)
    assert any(text.startswith("the maximum hardly depends on c") for text in found.words)


@pytest.mark.parametrize(
    ("question", "last", "beyond"),
    [
        pytest.param({"input": "a", "band": (10, 40)}, 30, "40", marks=pytest.mark.slow),
        pytest.param({"input": "a", "band": (10, 40)}, 40, None, marks=pytest.mark.nightly),
        ({"speeds": [150, 200], "speed_of": "a"}, 30, "31.831"),
    ],
)
def test_a_table_that_ends_before_the_band_or_the_highest_order_is_noted(question, last, beyond):
    plant = running(0.5)
    shaft = tn.TabulatedSpring("shaft", nodes=("a", "ground"), table=[[1, K, 0], [last, K, 0]])
    plant = tn.Drivetrain(
        "table", [part if part.name != "shaft" else shaft for part in plant.definition.elements.values()],
        parameters={"c": "100 N*m*s/rad", "k_film": "0 N*m/rad"}, excitations=plant.definition.excitations,
    )  # fmt: skip
    found = plant.damper_design("a", {"c": (100, 200)}, **question)
    end = f"go from 1 to {last} Hz, and it is read at up to {beyond} Hz, where the last row is kept"
    assert found.notes == ((f"shaft: the rows of its table {end}",) if beyond else ())
    assert found.words[-1:] == found.notes or not beyond


class TestWords:
    """Sentences on an optimum of which the curves are given."""

    @staticmethod
    def optimum(levels, fixed=(), unit="N*m*s/rad", value=3.0):
        return DamperOptimum(
            Channel("a", "rad"), ("frequency", "Hz"),
            (DesignParameter("c", unit, 1.0, 0.0, 6.0, value, np.arange(float(len(levels))), np.array(levels)),),
            LevelPeak(20.0, 9.0), LevelPeak(21.0, 1.0), (LevelPeak(21.0, 1.0),), (), fixed,
        )  # fmt: skip

    @pytest.mark.parametrize(
        ("levels", "count"), [([5, 2, 4, 1, 3], 2), ([5, 2, 4, 1, 1, 3], 2), ([5, 2, 1, 3], 1), ([1, 4, 2, 5, 3], 1)]
    )
    def test_minima_inside_the_bounds_are_counted(self, levels, count):
        more = f"; its curve has {count} minima, this is the lowest" if count > 1 else ""
        assert self.optimum(levels).words[0] == f"c is an optimum inside its bounds{more}"

    @pytest.mark.parametrize(
        ("unit", "level", "none"),
        [("N*m*s/rad", 1.0, True), ("N*m*s/rad", 0.9995, True), ("N*m*s/rad", 0.9, False), ("N*m/rad", 1.0, False)],
    )
    def test_dampings_alone_reach_no_less_than_the_first_fixed_point(self, unit, level, none):
        text = self.optimum([5, 1, 3], (FixedPoint(18.0, level, 0.0), FixedPoint(25.0, 0.5, 0.0)), unit).words[-1]
        same = "whatever the damping, the level at 18 and 25 Hz is the same"
        assert text == (f"{same}: none has a smaller maximum" if none else same)

    @pytest.mark.parametrize(
        ("value", "bound"), [(0.0, "lower"), (1e-3, None), (6.0, "upper"), (6 - 5e-4, "upper"), (5.99, None)]
    )
    def test_values_at_a_bound(self, value, bound):
        assert self.optimum([5, 1, 3], value=value).parameters[0].bound == bound


@pytest.mark.slow
def test_several_films_of_one_plant():
    """Against the best of a lattice of films on two dampers."""
    plant = tn.Drivetrain(
        "two ends",
        [
            tn.Inertia("left", node="a", inertia=1),
            tn.Inertia("right", node="b", inertia=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4),
            tn.ViscousDamper("one", node="a", ring_inertia=0.2, damping=20),
            tn.ViscousDamper("two", node="b", ring_inertia=0.2, damping=5),
        ],
        inputs={"T": {"torque": "a"}},
    )
    wanted = {"one.damping": (2, 200), "two.damping": (2, 200)}
    found = plant.damper_design("torque(shaft)", wanted, input="T", band=(5, 100))
    response = parametric_response(plant, "torque(shaft)", "T", np.linspace(12, 32, 200), list(wanted))
    lattice = [(one, two) for one in np.linspace(24, 30, 13) for two in np.linspace(20, 26, 13)]
    levels = [np.abs(response.evaluation(films).values).max() for films in lattice]
    assert found.after.level == pytest.approx(min(levels), rel=1e-3)
    assert tuple(found.values.values()) == pytest.approx(lattice[int(np.argmin(levels))], abs=1.5)  # the valley is flat


class TestPicture:
    @pytest.mark.slow
    def test_free_best_and_locked(self):
        found = untuned(0.5).damper_design("a", "c", input="a")
        assert [curve.label for curve in found.curves] == ["as given", "optimum", "free", "locked"]
        peaks = {curve.label: curve.points[np.argmax(curve.levels)] * 2 * np.pi / OMEGA for curve in found.curves}
        assert peaks["free"] == pytest.approx(1, rel=1e-3)
        assert peaks["locked"] == pytest.approx(1 / np.sqrt(1.5), rel=1e-3)
        figure = plot.damper_design(found)
        assert [axes.get_xlabel() for axes in figure.axes] == ["frequency [Hz]", "c [N·m·s/rad]"]


class TestRefusals:
    @pytest.mark.parametrize(
        ("settings", "words"),
        [
            ({"parameters": "d", "input": "a"}, "unknown-parameter"),
            ({"parameters": [], "input": "a"}, "missing-entry"),
            ({"parameters": {"c": (200, 100)}, "input": "a"}, "unordered-rows"),
            ({"parameters": {"c": (-1, 100)}, "input": "a"}, "no value below 0"),
            ({"parameters": {"c": ("10 N*m/rad", 100)}, "input": "a"}, r"(?s)10.*wrong-unit"),
            ({"parameters": {"c": ("10 frob", 100)}, "input": "a"}, "frob"),
            ({"parameters": {"c": (10,)}, "input": "a"}, "bounds are two values"),
            ({"parameters": "k_film", "input": "a"}, "missing-entry"),
            ({"parameters": "c", "input": "a", "band": (50, 20)}, "a band goes from"),
            ({"parameters": "c", "band": (5, 20)}, "missing-entry"),
            ({"parameters": "c", "input": "a", "speeds": [100.0]}, "contradicting-entries"),
            ({"parameters": "c"}, "missing-entry"),
        ],
    )
    def test_what_makes_no_sense(self, settings, words):
        with pytest.raises(tn.UsageError, match=words):
            untuned(0.5).damper_design("a", **settings)


class TestCommand:
    @pytest.mark.slow
    def test_screen_files_and_json(self, tmp_path):
        running(0.5, sensors={"theta": {"angle": "a"}}).to_yaml(tmp_path / "plant.yaml")
        words = ["damper", tmp_path / "plant.yaml", "--vary", "c=20..2000 N*m*s/rad", "--output", "theta"]
        text = run(*words, "--csv", tmp_path / "c.csv", "--plot", tmp_path / "c.png").stdout
        assert "c is an optimum inside its bounds" in text
        assert (tmp_path / "c.png").stat().st_size > 10_000
        rows = [line for line in (tmp_path / "c.csv").read_text().splitlines() if line.startswith("c,")]
        assert len(rows) >= 33
        (over_frequency,) = json.loads(run(*words, "--input", "a", "--band", 5, 60, "--json").stdout)
        (one,) = over_frequency["parameters"]
        assert one["value"] / (2 * 0.5 * J * OMEGA) == pytest.approx(0.36515, abs=2e-5)
        assert over_frequency["over"] == "frequency Hz"

    def test_half_a_band_and_half_a_range(self, tmp_path):
        running(0.5).to_yaml(tmp_path / "plant.yaml")
        words = ["damper", tmp_path / "plant.yaml", "--output", "a"]
        assert "requires 2 arguments" in run(*words, "--vary", "c", "--input", "a", "--band", 5, code=2).stderr
        assert "expected NAME[=LOW..HIGH]" in run(*words, "--vary", "c=5", code=2).stderr


@pytest.mark.parametrize("step", [3, 70])
def test_levels_over_speed_do_not_depend_on_the_step(step):
    """A film that hardly damps: one mass of J on K, whose narrow peak lies between the speeds of either grid."""
    plant = running(0.5)
    speeds = np.arange(1000.0, 2200.0, step) * np.pi / 30
    response = parametric_response(plant, "a", "a", [1.0], ["c", "k_film"])
    run_up = plant.order_response("a", speeds=speeds)
    levels = OrderLevels(VariedModel(response.unknowns), "a", None, run_up, refine=True)
    c, ring = 2.0, 0.5 * J
    near = np.linspace(0.9, 1.1, 200_001) * OMEGA
    film = 1j * near * c * (-ring * near**2) / (1j * near * c - ring * near**2)
    meant = 5 / np.abs(K - J * near**2 + film)
    points = levels.maxima(np.array([c, 0.0]))
    assert points[0] == pytest.approx(near[meant.argmax()], rel=1e-5)
    assert levels.sizes_at(np.array([c, 0.0]), points[:1]).item() == pytest.approx(meant.max(), rel=1e-3)


def test_the_largest_level_is_that_at_the_highest_maximum():
    """Of 9 - (f - 2)^2 on a grid that misses its top."""
    levels = SimpleNamespace(
        maxima=lambda _: np.array([2.0, 1.0]),
        grid=lambda _: np.array([0.0, 3.0]),
        sizes_at=lambda _, points: 9 - (points - 2) ** 2,
    )
    assert (largest(levels, None), largest(levels, None, refined=False)) == (9, 8)
