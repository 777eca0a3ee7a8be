"""The same-estimator route against the estimator itself, for a system that halves its input and delays it."""

import numpy as np
import pytest

from torsionnet.base.errors import UsageError
from torsionnet.identification.residuals.windowed_estimate import windowed_estimate
from torsionnet.signals import Recording, Signal, Welch, estimate

RATE, COUNT, LATE, SIZE = 100.0, 1000, 7, 0.5
BAND = (2.0, 30.0)
SETTINGS = [
    Welch("hann", 1.0, 0.5, detrend="mean"),
    Welch("hamming", 2.0, 0.75, detrend="linear"),
    Welch("hann", 0.64, 0.0, detrend="mean"),
]


def smooth(seed):
    """Noise below 35 Hz that begins at rest."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).normal(size=COUNT))
    spectrum[np.fft.rfftfreq(COUNT, 1 / RATE) > 35] = 0
    return np.concatenate([np.zeros(20), np.fft.irfft(spectrum, COUNT)])[:COUNT]


def delayed(values):
    return SIZE * np.concatenate([np.zeros(LATE), values[:-LATE]])


def delay(f):
    return SIZE * np.exp(-2j * np.pi * f * LATE / RATE)


def recorded(x, y):
    return Recording((Signal("x", "torque", x), Signal("y", "torque", y)), RATE)


def prepared(settings, x=None, y=None, band=BAND, settling=0.0):
    x = smooth(1) if x is None else x
    y = delayed(x) + smooth(2) if y is None else y
    return windowed_estimate(recorded(x, y), "y", "x", settings, band, settling)


def h1(x, y, settings, frequencies):
    found = estimate(recorded(x, y), "y", "x", "H1", settings)
    return np.array([found.values[np.argmin(abs(found.frequencies - f)), 0, 0] for f in frequencies])


def lines(values, settings, frequencies):
    """Windowed lines of every segment, (n_segments, n_b), one sample after the other."""
    length, step = settings.samples(RATE), settings.step(RATE)
    found = []
    for start in range(0, COUNT - length + 1, step):
        part = values[start : start + length]
        order = {"mean": 0, "linear": 1}[settings.detrend]
        part = part - np.polyval(np.polyfit(np.arange(length), part, order), np.arange(length))
        turn = np.exp(-2j * np.pi * np.outer(frequencies / RATE, np.arange(length)))
        found.append(turn @ (settings.weights(RATE) * part))
    return np.array(found)


def spread(rows):
    parts = np.concatenate([rows.real, rows.imag])
    return parts @ parts.T


@pytest.mark.parametrize("settings", SETTINGS)
class TestAgainstTheEstimator:
    def test_measured(self, settings):
        x, y = smooth(1), smooth(2)
        route = prepared(settings, x, y)
        np.testing.assert_allclose(route.measured, h1(x, y, settings, route.frequencies), rtol=1e-9)

    def test_lines_up_to_both_ends_of_the_band(self, settings):
        apart = 1 / settings.seconds
        band = (3 * apart, 20 * apart)
        np.testing.assert_allclose(prepared(settings, band=band).frequencies, np.arange(3, 21) * apart, rtol=1e-12)

    def test_predicted(self, settings):
        x = smooth(1)
        route = prepared(settings, x)
        expected = h1(x, delayed(x), settings, route.frequencies)
        G = delay(route.fine)
        np.testing.assert_allclose(route.predicted(G), expected, rtol=1e-6)
        both = route.predicted(np.column_stack([G, -2j * G]))
        np.testing.assert_allclose(both[:, 0], expected, rtol=1e-6)

    def test_leakage_is_in_it(self, settings):
        """What the estimator makes of the delay is not the delay."""
        route = prepared(settings)
        assert np.max(np.abs(route.predicted(delay(route.fine)) - delay(route.frequencies))) > 0.01

    def test_noise_on_the_output(self, settings):
        """The estimate is linear in the output: its response to one sample after the other."""
        x = smooth(1)
        route = prepared(settings, x)
        rows = np.array([h1(x, np.eye(COUNT)[at], settings, route.frequencies[:3]) for at in range(300, 500, 20)]).T
        np.testing.assert_allclose(route.rows.dense()[:3, 300:500:20], rows, atol=1e-9 * np.abs(rows).max())
        covariance = route.output_covariance()
        expected = spread(route.rows.dense())
        np.testing.assert_allclose(covariance, expected, rtol=1e-12, atol=1e-12 * expected.max())
        np.testing.assert_allclose(np.diag(covariance)[0], np.sum(route.rows.dense()[0].real ** 2), rtol=1e-12)

    def test_noise_on_the_input(self, settings):
        """A sample of noise comes out halved, some samples later."""
        route = prepared(settings)
        late = route.rows.dense()[:, LATE:]
        rows = SIZE * np.concatenate([late, np.zeros((len(late), LATE))], axis=1)
        expected = spread(rows)
        found = route.input_covariance(delay(route.fine))
        np.testing.assert_allclose(found, expected, atol=2e-3 * expected.max())

    def test_unexplained(self, settings):
        x, rest = smooth(1), smooth(3)
        route = prepared(settings, x, delayed(x) + rest)
        noise, drive = (np.abs(lines(values, settings, route.frequencies)) ** 2 for values in (rest, x))
        length = settings.samples(RATE)
        trend = np.vander(np.arange(length), {"mean": 1, "linear": 2}[settings.detrend])
        straight = np.eye(length) - trend @ np.linalg.pinv(trend)
        turn = np.exp(-2j * np.pi * np.outer(route.frequencies / RATE, np.arange(length)))
        white = np.sum(np.abs((turn * settings.weights(RATE)) @ straight) ** 2, axis=1)
        expected = np.sum(noise * drive, axis=0) / np.sum(drive, axis=0) / white
        np.testing.assert_allclose(route.unexplained(delay(route.fine)), expected, rtol=1e-5)

    def test_nothing_unexplained(self, settings):
        x = smooth(1)
        route = prepared(settings, x, delayed(x))
        assert np.max(route.unexplained(delay(route.fine))) < 1e-9 * np.mean(x**2)


class TestSettling:
    """Segments that begin before are left out, of test and prediction alike."""

    SETTINGS = SETTINGS[0]

    @pytest.mark.parametrize(("settling", "left_out"), [(0.0, 0), (0.5, 1), (0.6, 2), (1.0, 2)])
    def test_segments(self, settling, left_out):
        x, y = smooth(1), smooth(2)
        route = prepared(self.SETTINGS, x, y, settling=settling)
        X, Y = (lines(values, self.SETTINGS, route.frequencies)[left_out:] for values in (x, y))
        expected = np.sum(X.conj() * Y, axis=0) / np.sum(np.abs(X) ** 2, axis=0)
        np.testing.assert_allclose(route.measured, expected, rtol=1e-8)
        noise = np.sum(np.abs(X) ** 2 * np.abs(Y) ** 2, axis=0) / np.sum(np.abs(X) ** 2, axis=0)
        np.testing.assert_allclose(
            route.unexplained(0 * route.fine) / noise, route.unexplained(0 * route.fine)[0] / noise[0], rtol=1e-6
        )

    def test_too_short(self):
        prepared(self.SETTINGS, settling=9.0)
        with pytest.raises(UsageError, match=r"(?s)10 s.*too-short"):
            prepared(self.SETTINGS, settling=9.1)


def test_no_line_in_the_band():
    with pytest.raises(UsageError, match=r"(?s)2\.1 and 2\.9.*missing-data"):
        prepared(SETTINGS[0], band=(2.1, 2.9))
