"""Estimated frequency responses against pyFRF, scipy, closed forms under known noise, and simulated truth."""

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import scipy
from support.known_damping import two_light_modes

from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.comparison import difference, frac
from torsionnet.signals.estimators import Step, estimate, multiple_coherence, stepped_sine
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.resampling import blocks_in_order
from torsionnet.signals.spectra import cross_spectra
from torsionnet.signals.uncertainty import (
    half_power_bandwidth,
    peak_warnings,
    random_error,
    resolution_limit,
    significant_peaks,
)
from torsionnet.signals.welch import PAPER, Welch, effective_averages

RATE = 200
INERTIA, DAMPING, STIFFNESS = 0.078, 2.0, 200.0  # resonance at 8.06 Hz, damping ratio 25 %


def recorded(rate=RATE, start=0.0, **channels):
    quantities = {"T": "torque", "t": "angle"}
    return Recording(
        tuple(Signal(name, quantities[name[0]], np.asarray(v)) for name, v in channels.items()), rate, start
    )


def white(count, seed=0, size=1.0):
    return np.random.default_rng(seed).normal(scale=size, size=count)


def oscillator(torque, rate=RATE):
    """Angle of a damped oscillator, and its transfer function at the same sampling."""
    b, a = scipy.signal.cont2discrete(([1.0], [INERTIA, DAMPING, STIFFNESS]), 1 / rate, method="bilinear")[:2]
    return scipy.signal.lfilter(b[0], a, torque), lambda f: scipy.signal.freqz(b[0], a, f, fs=rate)[1]


def relative(values, truth):
    return np.abs(values / truth - 1)


@cache
def data():
    T1, T2 = white(8000, 1), white(8000, 2)
    t1 = scipy.signal.lfilter([0.3, 0.2], [1, -0.5], T1) + 0.4 * T2 + 0.2 * white(8000, 3)
    t2 = scipy.signal.lfilter([0.1, 0.6], [1, 0.3], T2) - 0.3 * T1 + 0.2 * white(8000, 4)
    return {"T1": T1, "T2": T2, "t1": t1, "t2": t2}


class TestAgainstOthers:
    def pyfrf(self, inputs, outputs, window):
        FRF = pytest.importorskip("pyFRF").FRF
        exc, resp = (np.array([data()[name] for name in names])[None] for names in (inputs, outputs))
        return FRF(RATE, exc, resp, resp_type="d", window=window, fft_len=400, nperseg=400, noverlap=320)

    @pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
    @pytest.mark.parametrize("window", ["boxcar", "hamming"])
    def test_one_input_agrees_with_pyfrf(self, estimator, window):
        name = "boxcar"
        if window == "hamming":
            name = "hamming_symmetric"
            try:
                scipy.signal.get_window(name, 8)
            except ValueError:
                pytest.skip("this scipy has no symmetric windows by name")
        other = self.pyfrf(["T1"], ["t1", "t2"], "none" if window == "boxcar" else window)
        own = estimate(recorded(**data()), ["t1", "t2"], "T1", estimator, Welch(name))
        theirs = other.get_FRF(estimator).transpose(2, 0, 1)[1:]
        np.testing.assert_allclose(own.values, theirs, rtol=1e-10)
        np.testing.assert_allclose(own.coherence[:, :, 0], other.get_coherence().T[1:], rtol=1e-10)
        np.testing.assert_allclose(own.frequencies, other.get_f_axis()[1:], rtol=1e-12)

    @pytest.mark.parametrize("estimator", ["H1", "H2"])
    def test_two_inputs_agree_with_pyfrf(self, estimator):
        other = self.pyfrf(["T1", "T2"], ["t1", "t2"], "none")
        spectra = cross_spectra(recorded(**data()), Welch("boxcar"))
        own = estimate(spectra, ["t1", "t2"], ["T1", "T2"], estimator)
        theirs = other.get_FRF(estimator).transpose(2, 0, 1)[1:]
        assert np.max(np.abs(own.values - theirs)) < 1e-10 * np.max(np.abs(theirs))
        coherence = multiple_coherence(spectra, ["t1", "t2"], ["T1", "T2"])
        np.testing.assert_allclose(coherence, other.get_coherence().T[1:].real, rtol=1e-10)

    @pytest.mark.parametrize(("detrend", "scipys"), [("none", False), ("mean", "constant"), ("linear", "linear")])
    def test_spectra_agree_with_scipy(self, detrend, scipys):
        own = cross_spectra(recorded(**data()), Welch("hamming", 2.0, 0.8, detrend), ["T1", "t1"])
        f, theirs = scipy.signal.csd(data()["T1"], data()["t1"], RATE, "hamming", 400, 320, detrend=scipys)
        kept = slice(0 if detrend == "none" else 1, None)
        np.testing.assert_allclose(own.frequencies, f[kept], rtol=1e-12)
        np.testing.assert_allclose(own.matrix[:, 0, 1], theirs[kept], rtol=1e-10, atol=1e-16)


class TestTruth:
    @pytest.mark.parametrize("estimator", ["H1", "H2", "Hv", "Hs"])
    def test_lag_grows_to_90_degrees_at_resonance(self, estimator):
        torque = 15 * scipy.signal.chirp(np.arange(20_000) / RATE, 0.1, 100, 80)
        angle, truth = oscillator(torque)
        response = estimate(recorded(T=torque, t=angle), "t", "T", estimator)
        band = (response.frequencies >= 1) & (response.frequencies <= 8)
        phase = response.phase[band, 0, 0]
        assert np.all(np.diff(phase) < 0)
        assert phase[0] == pytest.approx(-3.7, abs=1)
        assert phase[-1] == pytest.approx(-89, abs=3)
        assert np.max(relative(response.values[band, 0, 0], truth(response.frequencies[band]))) < 0.03

    def test_two_inputs_and_outputs(self):
        T1, T2 = white(100_000, 1), white(100_000, 2)
        T2 = T2 + 0.7 * T1  # correlated inputs: the ordinary quotient is wrong here
        near, truth = oscillator(T1)
        t1 = near + 0.01 * T2
        t2 = 0.02 * T1 - oscillator(T2)[0]
        record = recorded(T1=T1, T2=T2, t1=t1, t2=t2)
        f = cross_spectra(record).frequencies
        flat = np.ones_like(f)
        expected = np.stack([np.stack([truth(f), 0.01 * flat], 1), np.stack([0.02 * flat, -truth(f)], 1)], 1)
        for estimator in ("H1", "H2", "Hv"):
            response = estimate(record, ["t1", "t2"], ["T1", "T2"], estimator)
            assert response.values.shape == (len(f), 2, 2)
            assert np.max(np.abs(response.values - expected)[f < 90]) < 0.03 * np.max(np.abs(expected))
        assert np.min(multiple_coherence(cross_spectra(record), ["t1", "t2"], ["T1", "T2"])) > 0.98
        alone = estimate(record, "t2", "T1")
        assert np.max(np.abs(alone.values[:, 0, 0] - expected[:, 1, 0])) > 0.2 * np.max(np.abs(expected))

    def test_total_least_squares_of_several_inputs_reduces_to_that_of_one(self):
        T1, T2 = white(40_000, 1), white(40_000, 2)
        t = 0.5 * T1 + 0.3 * white(40_000, 3)
        record = recorded(T1=T1, T2=T2, t=t)
        both, single = (estimate(record, "t", names, "Hs", noise_ratio=2.0) for names in (["T1", "T2"], "T1"))
        assert np.max(relative(both.values[:, 0, 0], single.values[:, 0, 0])) < 0.15
        assert np.max(np.abs(both.values[:, 0, 1])) < 0.1


class TestNoise:
    """A gain of 2 between white signals, with white noise of known power added."""

    COUNT = 400_000
    SNR = 4.0

    def response(self, estimator, input_noise=0.0, output_noise=0.0, **settings):
        clean = white(self.COUNT, 1)
        torque = clean + white(self.COUNT, 2, input_noise)
        angle = 2 * clean + white(self.COUNT, 3, output_noise)
        return estimate(recorded(T=torque, t=angle), "t", "T", estimator, Welch("hann", 1.0, 0.5), **settings)

    def mean_gain(self, *args, **kwargs):
        return np.mean(self.response(*args, **kwargs).values[5:-5]).real

    def test_h1_is_unbiased_under_output_noise(self):
        assert self.mean_gain("H1", output_noise=2 / np.sqrt(self.SNR)) == pytest.approx(2, rel=0.003)

    def test_h2_is_too_large_under_output_noise(self):
        biased = self.mean_gain("H2", output_noise=2 / np.sqrt(self.SNR))
        assert biased == pytest.approx(2 * (1 + 1 / self.SNR), rel=0.005)

    def test_h2_is_unbiased_under_input_noise(self):
        assert self.mean_gain("H2", input_noise=1 / np.sqrt(self.SNR)) == pytest.approx(2, rel=0.003)

    def test_h1_is_too_small_under_input_noise(self):
        biased = self.mean_gain("H1", input_noise=1 / np.sqrt(self.SNR))
        assert biased == pytest.approx(2 / (1 + 1 / self.SNR), rel=0.005)

    def test_hs_is_unbiased_under_both_if_it_knows_their_ratio(self):
        noise = {"input_noise": 0.5, "output_noise": 0.8}
        assert self.mean_gain("Hs", noise_ratio=0.8**2 / 0.5**2, **noise) == pytest.approx(2, rel=0.003)
        assert self.mean_gain("H1", **noise) < 1.7
        assert self.mean_gain("H2", **noise) > 2.2

    def test_hv_is_hs_with_equal_noise(self):
        noise = {"input_noise": 0.5, "output_noise": 0.5}
        assert self.mean_gain("Hv", **noise) == pytest.approx(2, rel=0.003)

    def test_hs_runs_from_h2_to_h1(self):
        noise = {"input_noise": 0.5, "output_noise": 0.8}
        h1, h2 = (self.response(name, **noise).values for name in ("H1", "H2"))
        assert np.max(relative(self.response("Hs", noise_ratio=1e9, **noise).values, h1)) < 1e-8
        assert np.max(relative(self.response("Hs", noise_ratio=1e-9, **noise).values, h2)) < 1e-8
        equally_noisy = self.response("Hs", **noise).values
        np.testing.assert_allclose(np.abs(equally_noisy) ** 2, np.abs(h1 * h2), rtol=1e-10)

    def test_hr_is_unbiased_under_noise_on_both_sides(self):
        clean = white(self.COUNT, 1)
        noisy = recorded(T0=clean, T=clean + white(self.COUNT, 2), t=2 * clean + white(self.COUNT, 3, 2.0))
        settings = Welch("hann", 1.0, 0.5)
        response = estimate(noisy, "t", "T", settings=settings, reference="T0")
        assert np.mean(response.values[5:-5]).real == pytest.approx(2, rel=0.005)
        assert response.notes[-1].startswith("Hr with T0 as reference")
        assert np.mean(estimate(noisy, "t", "T", "H1", settings).values[5:-5]).real == pytest.approx(1, rel=0.01)

    def test_hr_of_two_noisy_inputs_with_three_references(self):
        first, second = white(self.COUNT, 1), white(self.COUNT, 2)
        record = recorded(
            T01=first + second,
            T02=first - second,
            T03=white(self.COUNT, 3),
            T1=first + white(self.COUNT, 4, 0.5),
            T2=second + white(self.COUNT, 5, 0.5),
            t=3 * first - second + white(self.COUNT, 6),
        )
        names = ["T01", "T02", "T03"]
        response = estimate(record, "t", ["T1", "T2"], settings=Welch("hann", 1.0, 0.5), reference=names)
        assert np.mean(response.values[5:-5, 0], axis=0).real == pytest.approx([3, -1], abs=0.02)

    def test_references_that_cannot_be(self):
        record = recorded(T0=white(4000, 1), T=white(4000, 2), T2=white(4000, 3), t=white(4000, 4))
        with pytest.raises(UsageError, match="wrong-count"):
            estimate(record, "t", "T", "Hr")
        with pytest.raises(UsageError, match="wrong-count"):
            estimate(record, "t", ["T", "T2"], reference="T0")
        with pytest.raises(UsageError, match="needless-entry"):
            estimate(record, "t", "T", "H1", reference="T0")
        (warning,) = [note for note in estimate(record, "t", "T", reference="T0").notes if "hardly" in note]
        assert re.match(r"warning: T0 explains \d(\.\d)? % of T: hardly what drives it", str(warning))

    def test_coherence(self):
        coherence = self.response("H1", input_noise=0.5, output_noise=0.8).coherence[5:-5]
        expected = 1 / (1 + 0.5**2) / (1 + 0.8**2 / 4)
        assert np.mean(coherence) == pytest.approx(expected, rel=0.003)


class TestUncertainty:
    def test_scatter_of_many_tests_is_as_predicted(self):
        found, predicted = [], []
        settings = Welch("hamming", 0.5, 0.8)
        for seed in range(150):
            torque = white(2000, 2 * seed)
            record = recorded(T=torque, t=2 * torque + white(2000, 2 * seed + 1, 2.0))
            spectra = cross_spectra(record, settings)
            response = estimate(spectra, "t", "T")
            found.append(response.values[5:-5, 0, 0])
            error = random_error(response.coherence[:, 0, 0], spectra.effective_averages)
            predicted.append(error.magnitude[5:-5])
        scatter = np.sqrt(np.mean(np.var(np.abs(found), axis=0))) / 2
        turn = np.sqrt(np.mean(np.var(np.angle(found), axis=0)))
        assert np.mean(predicted) == pytest.approx(scatter, rel=0.1)
        assert np.mean(predicted) == pytest.approx(turn, rel=0.1)

    def test_phase_of_nothing_is_any(self):
        error = random_error(np.array([0.0]), 10)
        assert error.phase == pytest.approx(180 / np.sqrt(3))
        assert np.isinf(error.magnitude)

    def test_effective_averages_of_overlap(self):
        window = scipy.signal.get_window("hann", 1000)
        assert effective_averages(window, 500, 1000) == pytest.approx(1000 * 36 / 38, rel=1e-3)
        assert effective_averages(window, 200, 1) == 1
        with pytest.raises(UsageError, match="must be positive"):
            random_error(np.array([0.5]), 0)


class TestBlocks:
    def cut(self, record, *places):
        edges = [0, *places, len(record)]
        for begin, end in pairwise(edges):
            signals = tuple(replace(s, values=s.values[begin:end]) for s in record)
            yield replace(record, signals=signals, start=record.start + begin / record.sampling_rate)

    @pytest.mark.parametrize("decimation", [1, 5])
    def test_parts_of_a_record_give_what_the_whole_gives(self, decimation):
        torque = white(20_000)
        record = recorded(T=torque, t=oscillator(torque)[0], start=3.0)
        settings = Welch(decimation=decimation)
        whole = cross_spectra(record, settings)
        parts = cross_spectra(self.cut(record, 17, 777, 9_001, 19_990), settings)
        assert parts.averages == whole.averages
        np.testing.assert_allclose(parts.matrix, whole.matrix, rtol=1e-9)

    def test_repeated_tests_are_averaged_without_crossing_the_gap(self):
        first, second = (recorded(T=white(1000, seed)) for seed in (1, 2))
        both = cross_spectra([first, second])
        alone = [cross_spectra(record) for record in (first, second)]
        assert alone[0].averages == (1000 - 400) // 80 + 1  # segments of 2 s at 200 Hz, by steps of a fifth of it
        assert both.averages == alone[0].averages + alone[1].averages
        np.testing.assert_allclose(both.matrix, (alone[0].matrix + alone[1].matrix) / 2, rtol=1e-12)
        assert both.effective_averages == pytest.approx(2 * alone[0].effective_averages)

    def test_which_blocks_follow_on_each_other(self):
        whole = recorded(T=white(100))
        assert [follows for _, follows in blocks_in_order(self.cut(whole, 30, 60))] == [False, True, True]
        assert [follows for _, follows in blocks_in_order([whole, whole])] == [False, False]

    @pytest.mark.parametrize(
        ("blocks", "message"),
        [
            ([recorded(T=white(500)), recorded(T1=white(500))], "unlike-results"),
            ([recorded(T=white(500)), recorded(T=white(500), rate=100)], r"(?s)200.*100.*unlike-results"),
            ([replace(recorded(T=white(500)), times=np.arange(500.0))], "not uniform"),
            ([recorded(T=np.full(500, np.nan))], r"(?s)500.*not-finite"),
            ([recorded(T=white(300))], r"(?s)1\.5.*too-short"),
            ([], "too short"),
        ],
    )
    def test_what_cannot_be_averaged(self, blocks, message):
        with pytest.raises(UsageError, match=message):
            cross_spectra(blocks)


class TestSingleTests:
    def test_stepped_sine(self):
        time = np.arange(40_000) / 1000
        steps = [Step(7.3, 0, 10), Step(3.0, 10, 20), Step(12.9, 20, 40)]
        frequency = np.select([time < 10, time < 20], [7.3, 3.0], 12.9)
        angle = 2 * np.pi * frequency * time
        record = recorded(1000, T=5 * np.sin(angle), t=0.2 * np.sin(angle - 1.0) + 0.3 + 0.05 * time)
        response = stepped_sine(record, "t", "T", steps, settling=0.5)
        assert response.frequencies.tolist() == [3.0, 7.3, 12.9]
        np.testing.assert_allclose(response.values[:, 0, 0], 0.04 * np.exp(-1j), rtol=1e-9)
        assert "3 steps" in response.notes[-1]

    def test_steps_are_told_in_the_time_of_the_record(self):
        time = 100 + np.arange(8000) / 1000
        angle = 2 * np.pi * np.where(time < 104, 5.0, 11.0) * time
        signals = Signal("T", "torque", 2 * np.sin(angle)), Signal("t", "angle", np.sin(angle - 0.5))
        found = stepped_sine(
            Recording(signals, 1000, 100.0), "t", "T", [Step(5, 100, 104), Step(11, 104, 108)], settling=0.3
        )
        np.testing.assert_allclose(found.values[:, 0, 0], 0.5 * np.exp(-0.5j), rtol=1e-9)
        with pytest.raises(UsageError, match="no whole period"):
            stepped_sine(Recording(signals, 1000, 100.0), "t", "T", [Step(5, 99.9, 104)])

    @pytest.mark.parametrize("step", [Step(0.5, 0, 1), Step(5, 30, 40), Step(5, -1, 1)])
    def test_step_without_a_whole_period(self, step):
        with pytest.raises(UsageError, match="no whole period"):
            stepped_sine(recorded(T=white(400), t=white(400)), "t", "T", [step])


class TestRemarks:
    def resonant(self, ratio, bins=0.5):
        f = np.arange(0.5, 60, bins)
        values = 1 / (1 - (f / 20) ** 2 + 2j * ratio * f / 20)
        return FrequencyResponse(f, values[:, None, None], (Channel("t", "rad"),), (Channel("T", "N*m"),))

    def test_narrow_peak(self):
        (remark,) = peak_warnings(self.resonant(0.01, 0.05), 0.5)
        assert str(remark).startswith("warning: t/T half-power bandwidth under 3 bins of 0.5 Hz at 20 Hz (0.4 Hz)")

    def test_wide_peak(self):
        response = self.resonant(0.1)
        peak = significant_peaks(response.magnitude[:, 0, 0])
        assert response.frequencies[peak].tolist() == [19.5] or response.frequencies[peak].tolist() == [20.0]
        assert half_power_bandwidth(response.frequencies, response.magnitude[:, 0, 0], peak[0]) > 3.5
        assert peak_warnings(response, 0.5) == ()

    def test_records_of_too_many_values_are_not_kept(self, monkeypatch):
        record = recorded(T=white(2000), t=white(2000, 1))
        assert len(estimate(record, "t", "T").estimation.record) == 2000
        monkeypatch.setattr("torsionnet.signals.uncertainty.MOST_KEPT_VALUES", 3999)
        assert estimate(record, "t", "T").estimation.record is None

    def test_low_coherence_at_a_peak(self):
        response = self.resonant(0.1)
        doubtful = replace(response, coherence=np.full((len(response.frequencies), 1, 1), 0.5))
        (remark,) = peak_warnings(doubtful, 0.5)
        assert "coherence under 0.8 at the peak at" in remark
        assert "(0.50)" in remark
        assert peak_warnings(doubtful, 0.5, judge_coherence=False) == ()

    def test_estimate_carries_its_remarks_and_settings(self):
        torque = white(10_000)
        record = recorded(T=torque, t=torque).with_notes("from a test")
        notes = estimate(record, "t", "T", "H2").notes
        assert notes[0] == "from a test"
        assert notes[1].startswith("H2, Welch, hamming 2 s, overlap 80%, detrend mean, 121 averages worth 46.2 without")
        assert len(notes) == 2
        twice = recorded(T1=torque, T2=2 * torque + 1e-6 * white(10_000, 1), t=torque)
        assert any("proportional at 200 frequencies" in n for n in estimate(twice, "t", ["T1", "T2"]).notes)
        short = recorded(T=torque[:500], t=white(500))
        assert any("of one segment" in n for n in estimate(short, "t", "T", settings=Welch(overlap=0)).notes)

    def test_resolution_limit(self):
        f = np.linspace(1, 10, 10)
        assert resolution_limit(f, 10.0 - f, step=1.0, steps=4) == pytest.approx(6)
        assert resolution_limit(f, 10.0 - f, step=1.0, steps=2.5) == pytest.approx(7.5)
        assert resolution_limit(f, 10.0 - f, step=0.01) == pytest.approx(9.96)
        assert resolution_limit(f, f, step=0.01) == 10
        assert resolution_limit(f, f, step=100.0) == 0
        with pytest.raises(UsageError, match="out-of-range"):
            resolution_limit(f, f, step=0.0)


class TestQuestions:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (("t", "T", "H3"), "unknown-word"),
            (("t", "t22"), r'(?s)did you mean "t2".*unknown-channel'),
            (("t", ["T", "t2"], "H2"), "wrong-count"),
            (("t", ["T", "t2"], "Hs"), "needs a noise ratio"),
            (("t", "T", "H1", None, 2.0), "belongs to Hs"),
            (("t", "T", "Hs", None, -2.0), "positive number"),
        ],
    )
    def test_wrong(self, arguments, message):
        with pytest.raises(UsageError, match=message):
            estimate(recorded(T=white(1000), t=white(1000, 1), t2=white(1000, 2)), *arguments)

    def test_settings_for_averaged_spectra(self):
        spectra = cross_spectra(recorded(T=white(1000), t=white(1000, 1)))
        with pytest.raises(UsageError, match="averaged already"):
            estimate(spectra, "t", "T", settings=PAPER)
        with pytest.raises(UsageError, match="unknown-channel"):
            estimate(spectra, "u", "T")

    @pytest.mark.parametrize("wrong", [{"overlap": 1.0}, {"seconds": 0.0}, {"detrend": "constant"}])
    def test_settings(self, wrong):
        with pytest.raises(UsageError):
            Welch(**wrong)

    def test_settings_of_the_paper(self):
        time = np.arange(1_000_000) / 10e3
        torque = 15 * scipy.signal.chirp(time, 0.1, 100, 80)
        angle, truth = oscillator(torque, 10e3)
        response = estimate(recorded(10e3, T=torque, t=angle), "t", "T", settings=PAPER)
        band = response.frequencies <= 70
        np.testing.assert_allclose(np.diff(response.frequencies), 0.5)
        assert np.max(relative(response.values[band, 0, 0], truth(response.frequencies[band]))) < 0.05
        assert any(note.startswith("H2, Welch, hamming 2 s, overlap 80%") for note in map(str, response.notes))
        assert any("to 200 Hz" in note and "holds up to 80 Hz" in note for note in response.notes)


class TestComparison:
    def response(self, values, frequencies=(1.0, 2.0, 3.0), unit="rad"):
        values = np.asarray(values, dtype=complex)[:, None, None]
        return FrequencyResponse(np.asarray(frequencies), values, (Channel("t", unit),), (Channel("T", "N*m"),))

    def test_difference(self):
        apart = difference(self.response([2, 2j, -10]), self.response([1, 2, 1]))
        np.testing.assert_allclose(apart.decibels[:, 0, 0], [20 * np.log10(2), 0, 20], atol=1e-12)
        np.testing.assert_allclose(apart.degrees[:, 0, 0], [0, 90, 180], atol=1e-12)

    def test_frac(self):
        one = self.response([1, 2j, -1])
        assert frac(one, self.response([3j, -6, -3j])).item() == pytest.approx(1)
        assert frac(one, self.response([2, 0, 2])).item() == pytest.approx(0)
        assert frac(one, self.response([1, 0, 0])).item() == pytest.approx(1 / 6)

    @pytest.mark.parametrize(
        ("other", "message"),
        [
            ({"frequencies": (1.0, 2.0, 3.1)}, "unlike-results"),
            ({"frequencies": (1.0, 2.0, 3.000001)}, "unlike-results"),
            ({"unit": "rad/s"}, "unlike-results"),
        ],
    )
    def test_not_comparable(self, other, message):
        one, two = self.response([1, 2, 3]), self.response([1, 2, 3], **other)
        for compare in (difference, frac):
            with pytest.raises(UsageError, match=message):
                compare(one, two)


class TestBand:
    """Only what was asked for is kept, and judged."""

    def test_warnings_are_about_the_band_alone(self):
        record = two_light_modes()
        whole = estimate(record, "t", "T")
        assert any("at 5 Hz" in note and "48 Hz" in note for note in whole.notes)
        low = estimate(record, "t", "T", band=(0.5, 20))
        assert any("at 5 Hz" in note for note in low.notes)
        assert not any("48 Hz" in note for note in low.notes)
        assert estimate(record, "t", "T", band=(20, 40)).notes == whole.notes[:-1]
        np.testing.assert_array_equal(low.values, whole.between(0.5, 20).values)
        assert (low.frequencies[0], low.frequencies[-1]) == (0.5, 20)

    def test_inputs_that_are_proportional_elsewhere(self):
        common, own = white(40_000, 6), scipy.signal.lfilter(*scipy.signal.butter(8, 30, fs=RATE), white(40_000, 7))
        record = recorded(T1=common, T2=common + own, t=white(40_000, 8))
        assert any("all but proportional" in note for note in estimate(record, "t", ["T1", "T2"]).notes)
        assert not any("proportional" in note for note in estimate(record, "t", ["T1", "T2"], band=(1, 20)).notes)

    def test_decimation_limits_the_same_whatever_the_band(self):
        record = two_light_modes()
        settings = Welch(decimation=2)
        assert estimate(record, "t", "T", settings=settings, band=(0, 10)).usable_up_to == 40
