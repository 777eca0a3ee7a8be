"""Fits whose every number can be worked out by hand: one free inertia, straight lines in its logarithm.

Each line says an inertia J_i and a lag of its own. Logarithms of model over test are then log(J_i / J) and, with a delay,
the lag less 2 pi f d; both divided by sqrt((1 - c) / (2 c)) for a coherence c. That is linear in log J and in d. The
frequencies are no multiples of one step, so the lines are no neighbours in a window and share no errors.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.identification import Candidate, choose_model
from torsionnet.identification.fit_problem import FitProblem
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.linear.frequency_response import Channel, FrequencyResponse

F = np.array([1.0, 2.1, 3.4, 5.3, 8.2])
INERTIA = np.array([1.9, 2.2, 2.05, 2.1, 1.8])
LAG = np.array([0.02, -0.01, 0.05, 0.03, 0.08])
COHERENCE = np.array([0.99, 0.6, 0.9, 0.3, 0.95])
WEIGHT = 2 * COHERENCE / (1 - COHERENCE)
TURN = 2 * np.pi * F
LOG = np.sum(WEIGHT * np.log(INERTIA)) / np.sum(WEIGHT)
BEST = np.exp(LOG)


def disc(inertia=1.0, damping=0.0):
    elements = [tn.Inertia("disc", node="a", inertia="J"), tn.Damper("drag", nodes=("a", "ground"), damping="c")]
    sensors = {"phi": {"angle": "a"}}
    return tn.Drivetrain("disc", elements, {"J": inertia, "c": damping}, inputs={"T": {"torque": "a"}}, sensors=sensors)


def said(inertia=INERTIA, lag=LAG, coherence=COHERENCE):
    values = -np.exp(-1j * lag) / (inertia * TURN**2)
    shape = (len(F), 1, 1)
    units = (Channel("phi", "rad"),), (Channel("T", "N*m"),)
    return FrequencyResponse(
        F, values.reshape(shape), *units, coherence=None if coherence is None else coherence.reshape(shape)
    )


def measured(data=None, name="run", **more):
    return tn.Measurement(said() if data is None else data, "phi", "T", name=name, **more)


def fitted(parameters="J", measurements=None, **more):
    return tn.identify(disc(), measured() if measurements is None else measurements, parameters, residual="log", **more)


def weighted(values, weights=WEIGHT):
    return float(np.sum(weights * values))


class TestOneInertia:
    SQUARES = weighted(np.log(INERTIA / BEST) ** 2 + LAG**2)
    ERROR = np.sqrt(SQUARES / 9 / np.sum(WEIGHT))

    def test_value_is_the_weighted_mean_of_logarithms(self):
        assert fitted().values["J"] == pytest.approx(BEST, rel=1e-9)

    def test_standard_error(self):
        assert fitted().standard_errors["J"] == pytest.approx(BEST * self.ERROR, rel=1e-6)

    @pytest.mark.parametrize("level", [0.5, 0.95])
    def test_intervals(self, level):
        fit, reach = fitted(), scipy.stats.t.ppf((1 + level) / 2, 9) * self.ERROR
        assert fit.degrees_of_freedom == 9
        assert fit.intervals(level)["J"] == pytest.approx((BEST * (1 - reach), BEST * (1 + reach)), rel=1e-6)
        ends = (BEST * np.exp(-reach), BEST * np.exp(reach))
        assert fit.profile("J", level) == pytest.approx(ends, abs=2e-3 * BEST * self.ERROR)

    @pytest.mark.parametrize("level", [0.0, 1.0, 1.5])
    def test_level_is_a_share(self, level):
        with pytest.raises(UsageError, match="out-of-range"):
            fitted().intervals(level)

    def test_chi_squared_and_what_follows_from_it(self):
        fit = fitted()
        assert fit.chi_squared == pytest.approx(self.SQUARES, rel=1e-9)
        assert fit.aicc == pytest.approx(self.SQUARES + 2 + 4 / (10 - 1 - 1), rel=1e-9)
        assert f"reduced chi squared {self.SQUARES / 9:.3g}," in fit.notes[0]
        assert fit.comparisons[0].misfit == pytest.approx(np.sqrt(self.SQUARES / 10), rel=1e-9)

    def test_deviation_of_a_line_is_what_its_coherence_says(self):
        (compared,) = fitted().comparisons
        sizes = 1 / (INERTIA * TURN**2)
        np.testing.assert_allclose(compared.deviation, sizes / np.sqrt(WEIGHT), rtol=1e-12)
        np.testing.assert_allclose(compared.fitted, -1 / (BEST * TURN**2), rtol=1e-8)
        assert (compared.name, compared.unit) == ("run", "rad/(N*m)")

    def test_without_coherence_every_line_counts_alike(self):
        fit = fitted(measurements=measured(said(coherence=None)))
        assert fit.values["J"] == pytest.approx(np.exp(np.mean(np.log(INERTIA))), rel=1e-9)
        assert fit.chi_squared == pytest.approx(np.sum((np.log(INERTIA) - np.mean(np.log(INERTIA))) ** 2 + LAG**2))

    @pytest.mark.parametrize(("given", "taken"), [(1.0, 1 - 1e-6), (0.0, 1e-3)])
    def test_coherence_is_never_all_or_nothing(self, given, taken):
        coherence = np.where(F == F[2], given, 0.5)
        weights = np.where(F == F[2], 2 * taken / (1 - taken), 2.0)
        expected = np.exp(weighted(np.log(INERTIA), weights) / np.sum(weights))
        assert fitted(measurements=measured(said(coherence=coherence))).values["J"] == pytest.approx(expected, rel=1e-9)

    def test_complex_residuals(self):
        """Model over test less 1 is g J_i exp(j lag) - 1 with g = 1 / J: linear in g."""
        ratio = INERTIA * np.exp(1j * LAG)
        g = weighted(ratio.real) / weighted(np.abs(ratio) ** 2)
        fit = tn.identify(disc(), measured(), "J")
        assert fit.values["J"] == pytest.approx(1 / g, rel=1e-8)
        squares = weighted(np.abs(g * ratio - 1) ** 2)
        assert fit.chi_squared == pytest.approx(squares, rel=1e-9)
        error = np.sqrt(squares / 9 / weighted(np.abs(ratio) ** 2)) / g**2
        assert fit.standard_errors["J"] == pytest.approx(error, rel=1e-6)


class TestDelay:
    DELAY = weighted(TURN * LAG) / weighted(TURN**2)
    SQUARES = weighted(np.log(INERTIA / BEST) ** 2 + (LAG - TURN * DELAY) ** 2)

    def test_value_and_error(self):
        fit = fitted(measurements=measured(delay=True))
        assert fit.values["J"] == pytest.approx(BEST, rel=1e-7)
        assert fit.values["delay[run]"] == pytest.approx(self.DELAY, rel=1e-7)
        assert fit.chi_squared == pytest.approx(self.SQUARES, rel=1e-9)
        errors = np.sqrt(self.SQUARES / 8 / np.array([np.sum(WEIGHT), weighted(TURN**2)])) * [BEST, 1]
        assert list(fit.standard_errors.values()) == pytest.approx(errors, rel=1e-6)
        np.testing.assert_allclose(fit.correlation, np.eye(2), atol=1e-9)
        assert fit.degrees_of_freedom == 8

    def test_profile(self):
        fit = fitted(measurements=measured(delay=True))
        low, high = fit.profile("delay[run]")
        assert (low, high) == pytest.approx(fit.intervals()["delay[run]"], abs=2e-3 * (high - low))

    def test_inertia_and_gain_cannot_be_told_apart(self):
        fit = fitted(measurements=measured(gain=True))
        assert fit.standard_errors == {"J": np.inf, "gain[run]": np.inf}
        assert fit.values["gain[run]"] / fit.values["J"] == pytest.approx(1 / BEST, rel=1e-9)
        assert [text.split(":")[0] for text in fit.verdicts] == ["J and gain[run] cannot be told apart in run alone"]
        assert fit.correlation[0, 1] == pytest.approx(1)


class TestProfileAtBounds:
    """The closed form's lower end lies 0.06 below the value."""

    LOW = BEST * np.exp(-2.262157162798205 * TestOneInertia.ERROR)  # scipy.stats.t.ppf(0.975, 9)

    @pytest.mark.parametrize(("bound", "end"), [(LOW + 0.01, LOW + 0.01), (LOW - 0.01, LOW), (0.0, LOW)])
    def test_below(self, bound, end):
        fit = fitted({"J": tn.Unknown(start=2.0, bounds=(bound, 10.0))})
        assert fit.profile("J")[0] == pytest.approx(end, abs=2e-3 * BEST * TestOneInertia.ERROR)

    @pytest.mark.parametrize("more", [0.01, 0.03])
    def test_above(self, more):
        fit = fitted({"J": tn.Unknown(start=1.5, bounds=(1.0, BEST + more))})
        assert fit.profile("J")[1] == pytest.approx(BEST + more, rel=1e-12)

    def test_value_at_its_bound(self):
        low, high = fitted({"J": tn.Unknown(start=3.0, bounds=(2.5, 4.0))}).profile("J")
        squares = weighted(np.log(2.5 / INERTIA) ** 2 + LAG**2)
        slope = np.sum(WEIGHT)
        error = np.sqrt(squares / 9 / slope)
        # Chi squared above the bound, less that at it: slope (log J - log BEST)^2 less its start.
        rise = squares / 9 * scipy.stats.f.ppf(0.95, 1, 9)
        expected = BEST * np.exp(np.sqrt((np.log(2.5) - LOG) ** 2 + rise / slope))
        assert (low, high) == pytest.approx((2.5, expected), abs=2e-3 * 2.5 * error)

    @pytest.mark.slow
    def test_what_is_not_determined_goes_from_bound_to_bound(self):
        """Down to no inertia at all, of which there is no response."""
        fit = fitted(measurements=measured(gain=True))
        assert fit.profile("J") == (0.0, np.inf)
        bounded = fitted({"J": tn.Unknown(bounds=(0.5, 30.0))}, measured(gain=True))
        assert bounded.profile("J") == (0.5, 30.0)

    def test_of_a_fit_that_was_saved(self, tmp_path):
        fitted().to_yaml(tmp_path / "fit.yaml")
        with pytest.raises(UsageError, match="missing-data"):
            tn.identification.load_fit(tmp_path / "fit.yaml").profile("J")


class TestPrior:
    @pytest.mark.parametrize(("mean", "deviation"), [(3.0, 0.05), (1.5, 0.2)])
    def test_counts_like_a_measurement(self, mean, deviation):
        fit = fitted({"J": tn.Unknown(prior=(mean, deviation))})
        J = fit.values["J"]
        assert weighted(np.log(J / INERTIA)) / J + (J - mean) / deviation**2 == pytest.approx(0, abs=1e-5 * sum(WEIGHT))
        assert (J - BEST) * (mean - BEST) > 0
        squares = weighted(np.log(INERTIA / J) ** 2 + LAG**2) + ((J - mean) / deviation) ** 2
        assert fit.chi_squared == pytest.approx(squares, rel=1e-9)
        assert fit.degrees_of_freedom == 10
        error = np.sqrt(squares / 10 / (np.sum(WEIGHT) / J**2 + 1 / deviation**2))
        assert fit.standard_errors["J"] == pytest.approx(error, rel=1e-6)


class TestSeveral:
    OTHER = 1.3 * INERTIA[::-1]

    def both(self):
        return [measured(), measured(said(self.OTHER), name="other")]

    def test_shared(self):
        together = np.exp((LOG * np.sum(WEIGHT) + weighted(np.log(self.OTHER))) / (2 * np.sum(WEIGHT)))
        fit = fitted(measurements=self.both())
        assert fit.values["J"] == pytest.approx(together, rel=1e-9)
        assert fit.degrees_of_freedom == 19

    def test_each_its_own(self):
        fit = fitted({"J": tn.Unknown(per_configuration=True)}, self.both())
        other = np.exp(weighted(np.log(self.OTHER)) / np.sum(WEIGHT))
        assert fit.values == pytest.approx({"J[run]": BEST, "J[other]": other}, rel=1e-9)
        np.testing.assert_allclose(fit.correlation, np.eye(2), atol=1e-9)
        assert fit.degrees_of_freedom == 18

    def test_one_that_does_not_fit_the_others(self):
        """Its response is off by more than twice what theirs are."""
        odd = [
            measured(said(INERTIA * factor, 0 * LAG), name=name)
            for name, factor in zip("abc", (1, 1, 1.3), strict=True)
        ]
        fit = fitted(measurements=odd)
        (verdict,) = fit.verdicts

        def off(factor):
            sizes = 1 / (factor * INERTIA * TURN**2)
            return 100 * np.sqrt(np.sum((1 / (fit.values["J"] * TURN**2) - sizes) ** 2) / np.sum(sizes**2))

        assert verdict.startswith(
            f"c does not fit the others: its response is off by {off(1.3):.2g} % (RMS), theirs by {off(1):.2g} %;"
        )


@dataclass
class Stub:
    """A block of so many lines, with a correlation of its noise and what all its lines share."""

    frequencies: np.ndarray
    correlation: np.ndarray | None
    shared: np.ndarray | None

    noise_covariance, squared_correlations = MeasurementBlock.noise_covariance, MeasurementBlock.squared_correlations

    @property
    def count(self):
        return 2 * len(self.frequencies)

    def shared_covariance(self, backward, _values):
        return 0 if self.shared is None else backward @ self.shared @ backward.T


class TestUncertainty:
    """Of two measurements and a prior: sums of quadratic forms, block after block."""

    NOISE = np.array([[1, 0.5, 0, 0], [0.5, 1, 0, 0], [0, 0, 1, -0.25], [0, 0, -0.25, 1]])
    STEPS = np.outer([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 4.0])
    BACKWARD = np.arange(14.0).reshape(2, 7) / 10

    def problem(self, priors):
        blocks = Stub(np.ones(1), None, None), Stub(np.ones(2), self.NOISE, self.STEPS)
        none = np.zeros(1)
        return FitProblem(("a",), none, none, none, priors, blocks, (np.array([0]),) * 2)

    def whole(self, *parts):
        found = np.zeros((7, 7))
        for place, part in parts:
            found[place, place] = part
        return self.BACKWARD @ found @ self.BACKWARD.T

    def test_under_noise(self):
        first, second, prior = slice(0, 2), slice(2, 6), slice(6, 7)
        expected = self.whole((first, np.eye(2)), (second, self.NOISE), (prior, np.eye(1)))
        np.testing.assert_allclose(self.problem({0: (1.0, 2.0)}).noise_covariance(self.BACKWARD), expected, rtol=1e-12)

    def test_under_shared(self):
        expected = self.whole((slice(2, 6), self.STEPS))
        np.testing.assert_allclose(
            self.problem({0: (1.0, 2.0)}).shared_covariance(self.BACKWARD, np.zeros(1)), expected, rtol=1e-12
        )

    def test_effective_count(self):
        """Of n correlated values: n^2 over the sum of squared correlations."""
        assert self.problem({}).effective_count == pytest.approx(36 / (2 + 4 + 2 * 0.25 + 2 * 0.0625))
        assert self.problem({0: (1.0, 2.0)}).effective_count == pytest.approx(49 / (7 + 2 * 0.25 + 2 * 0.0625))


def test_saved_files_are_of_version_one():
    """Files that are there have to be readable."""
    assert fitted().to_yaml().splitlines()[0] == "torsionnet_fit: 1"


class TestVerdicts:
    def test_at_a_bound(self):
        fit = fitted({"J": tn.Unknown(start=3.0, bounds=(2.5, 4.0))})
        assert fit.values["J"] == pytest.approx(2.5, rel=1e-6)
        assert fit.verdicts == ("J stands at its bound 2.5: its standard error means nothing there",)

    def test_vague(self):
        """A scatter of logarithms of 1 over 5 lines: 0.32 of the value, more than 0.3."""
        spread = np.array([-1.0, 1.0, 0.0, 1.0, -1.0]) * 1.5
        fit = fitted(measurements=measured(said(np.exp(spread), 0 * LAG, None)))
        error = np.sqrt(np.sum(spread**2) / 9 / 5)
        assert error > 0.3
        assert fit.verdicts == (f"J is hardly determined: 1 with a standard error of {error:.2g}",)

    def test_nothing_to_say(self):
        assert fitted().verdicts == ()


class TestChoice:
    """Drag from nowhere explains nothing: two parameters cost more than one."""

    def choice(self):
        lag, truth = np.arctan2(0.7, 2.0 * TURN), np.hypot(2.0, 0.7 / TURN)
        data = measured(said(truth * (1 + 0.01 * np.array([1, -1, 0, 1, -1])), -lag, None))
        candidates = {
            "free": Candidate(disc(2.2, 0.0), ["J"]),
            "dragged": Candidate(disc(2.2, 0.5), ["J", "c"]),
        }
        return choose_model(candidates, data)

    def test_the_better_comes_first(self):
        choice = self.choice()
        assert choice.best == "dragged"
        assert list(choice.fits) == ["dragged", "free"]
        assert choice.fits["dragged"].values == pytest.approx({"J": 2.0, "c": 0.7}, rel=0.05)

    def test_weighed_by_what_the_closest_leaves(self):
        """Its reduced chi squared is then 1, and the noise of every line that share of its size."""
        choice = self.choice()
        best, other = choice.fits["dragged"], choice.fits["free"]
        assert best.chi_squared == pytest.approx(8, rel=1e-6)
        assert choice.differences["dragged"] == 0
        assert choice.differences["free"] == pytest.approx(other.aicc - best.aicc)
        closest, another = best.comparisons[0], other.comparisons[0]
        off = [np.sum(np.abs((one.fitted - one.measured) / closest.fitted) ** 2) for one in (closest, another)]
        assert other.chi_squared / best.chi_squared == pytest.approx(off[1] / off[0], rel=1e-6)

    def test_in_a_table(self):
        choice = self.choice()
        rows = choice.table().rows
        assert [row[0] for row in rows] == ["dragged", "free"]
        assert rows[0][2:] == (0.0, pytest.approx(np.sqrt(8 / 10), rel=1e-6))
        assert rows[1][3] == pytest.approx(np.sqrt(choice.fits["free"].chi_squared / 10), rel=1e-6)

    @pytest.mark.parametrize(("has_phase", "closest"), [(True, "dragged"), (False, "free")])
    def test_the_closest_is_so_in_phase_only_where_the_test_has_phases(self, has_phase, closest):
        """Magnitudes of an inertia alone, all 0.3 rad late as a drag would turn them: its magnitudes fit worse."""
        data = said(2.0 * (1 + 0.01 * np.array([1, -1, 0, 1, -1])), np.full(5, -0.3), None)
        if not has_phase:
            data = replace(data, values=np.abs(data.values), has_phase=False)
        candidates = {"free": Candidate(disc(2.2, 0.0), ["J"]), "dragged": Candidate(disc(2.2, 8.0), ["J"])}
        choice = choose_model(candidates, measured(data))
        count = 10 if has_phase else 5
        assert choice.fits[closest].chi_squared == pytest.approx(count - 1, rel=1e-6)
        (other,) = {"free", "dragged"} - {closest}
        assert choice.fits[other].chi_squared > count
