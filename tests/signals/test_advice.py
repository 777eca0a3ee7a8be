"""What is said about an estimated response, and about test against model, in numbers made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from torsionnet.base.conventions import Conventions
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.comparison import agreement
from torsionnet.signals.uncertainty import half_power_bandwidth, peak_warnings, significant_peaks

F = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])


def response(magnitude, degrees=0.0, f=F, output="rad", **more):
    values = np.asarray(magnitude) * np.exp(1j * np.radians(degrees)) * np.ones(len(f))
    channels = (Channel("phi", output),), (Channel("T", "N*m"),)
    return FrequencyResponse(f, values[:, None, None], *channels, "rig", **more)


class TestAgreement:
    """Larger by known dB and turned by known degrees, line by line."""

    DB = np.array([1.0, -3.0, 0.5, 2.0, 1.0, 6.0])
    DEGREES = np.array([-5.0, 2.0, 10.0, -20.0, 0.0, 30.0])
    MODEL = np.array([1.0, 2.0, 4.0, 3.0, 1.0, 0.5])
    ALL = slice(0, 6)

    def found(self, coherence=None, usable=None, conventions=None):
        shape = (6, 1, 1)
        test = response(self.MODEL * 10 ** (self.DB / 20), self.DEGREES, usable_up_to=usable)
        if coherence is not None:
            test = replace(test, coherence=np.asarray(coherence).reshape(shape))
        return agreement(test, response(self.MODEL), conventions or Conventions())

    @pytest.mark.parametrize(
        ("coherence", "usable", "kept", "span"),
        [
            (None, None, [0, 1, 2, 3, 4, 5], "over 6 lines from 1 to 6 Hz"),
            (None, 5.0, [0, 1, 2, 3, 4], "over 5 lines from 1 to 5 Hz"),
            ([0.79, 0.8, 1, 0.9, 1, 0.1], None, [1, 2, 3, 4], "over 4 lines from 2 to 5 Hz"),
            ([1, 1, 0.9, 0, 1, 1], 4.5, [0, 1, 2], "over 3 lines from 1 to 3 Hz"),
        ],
    )
    def test_numbers(self, coherence, usable, kept, span):
        table = self.found(coherence, usable)
        rows = {row[0]: row[1:] for row in table.rows}
        test = (self.MODEL * 10 ** (self.DB / 20))[kept]
        at = np.argmax(test)
        assert rows["largest response of the test"] == (F[kept][at], pytest.approx(test[at]), "rad/(N*m)")
        assert rows["largest response of the model"] == (3, pytest.approx(4), "rad/(N*m)")
        for what, values, unit in (("magnitude", self.DB, "dB"), ("phase", self.DEGREES, "deg")):
            worst = kept[int(np.argmax(abs(values[kept])))]
            assert rows[f"largest difference in {what}"] == (F[worst], pytest.approx(values[worst]), unit)
            expected = np.sqrt(np.mean(values[kept] ** 2))
            assert rows[f"RMS difference in {what}"] == (None, pytest.approx(expected), unit)
        turned = test * np.exp(1j * np.radians(self.DEGREES[kept]))
        frac = (
            abs(np.vdot(turned, self.MODEL[kept])) ** 2 / np.vdot(turned, turned).real / np.sum(self.MODEL[kept] ** 2)
        )
        assert rows["FRAC"] == (None, pytest.approx(frac), "1")
        usable_line = () if usable is None else (f"the test can be used up to {usable:.4g} Hz",)
        assert table.notes == (
            f"{span} with coherence of 0.8 or more",
            *usable_line,
            "differences are test - model; positive degrees: the test leads",
        )
        assert table.title == "rig: phi/T"

    def test_in_degrees(self):
        rows = self.found(conventions=Conventions(angle="deg")).rows
        assert rows[1][2:] == (pytest.approx(4 * 180 / np.pi), "deg/(N*m)")
        assert rows[2][2] == pytest.approx(6)

    def test_nothing_to_compare(self):
        table = self.found(np.full(6, 0.5))
        assert (table.rows, table.notes) == ((), ("no frequency at which the test is good",))


def towers(heights, floor=0.1):
    """Peaks 10 Hz apart, of triangles 4 Hz wide at their feet, over lines of 0.5 Hz."""
    f = np.arange(0, 10 * len(heights) + 10, 0.5)
    values = np.full(len(f), floor)
    for place, height in enumerate(heights, 1):
        values = np.maximum(values, height * (1 - abs(f - 10 * place) / 2))
    return f, values


class TestPeaks:
    @pytest.mark.parametrize(
        ("heights", "expected"),
        [
            ([1.0, 0.5], [10, 20]),
            ([1.0, 0.15, 1.0], [10, 20, 30]),  # 16 dB below the highest, 3.5 dB above the floor
            ([1.0, 0.13, 1.0], [10, 30]),  # 2.3 dB above the floor
            ([10.0, 0.9, 1.1], [10, 30]),  # 20.9 and 19.2 dB below the highest
            ([], []),
        ],
    )
    def test_stand_out_and_are_not_too_low(self, heights, expected):
        f, values = towers(heights)
        assert [f[place] for place in significant_peaks(values)] == expected

    def test_zeros_and_missing_values_are_no_peaks(self):
        f, values = towers([1.0, 1.0])
        values[f == 0] = 0
        values[f == 15] = np.nan
        assert [f[place] for place in significant_peaks(values)] == [10, 20]
        assert significant_peaks(np.zeros(0)) == []

    def test_width_of_a_triangle(self):
        """It has fallen by 3 dB at a share of 0.293 of its half width."""
        f, values = towers([1.0])
        assert half_power_bandwidth(f, values, list(f).index(10)) == pytest.approx(4 * (1 - np.sqrt(0.5)), rel=1e-12)

    @pytest.mark.parametrize("side", [slice(None, 21), slice(20, None)])
    def test_no_width_on_one_side_alone(self, side):
        f, values = towers([1.0])
        assert np.isnan(half_power_bandwidth(f[side], values[side], int(np.argmax(values[side]))))


class TestRemarks:
    WIDTH = 4 * (1 - np.sqrt(0.5))

    def said(self, heights, bins, coherence=None, **more):
        f, values = towers(heights)
        shaped = (
            None if coherence is None else np.interp(f, 10 * np.arange(1, len(coherence) + 1), coherence)[:, None, None]
        )
        return tuple(map(str, peak_warnings(response(values, f=f, coherence=shaped, **more), bins)))

    def test_narrow(self):
        (said,) = self.said([1.0, 2.0], 0.4)
        assert said == (
            "warning: phi/T half-power bandwidth under 3 bins of 0.4 Hz at 10 Hz (1.17 Hz), 20 Hz (1.17 Hz): "
            "the height reads low and the damping high; use longer segments"
        )
        assert self.said([1.0, 2.0], self.WIDTH / 3 * 0.999) == ()

    @pytest.mark.parametrize(
        ("count", "ending"), [(5, "50 Hz (1.17 Hz):"), (6, "50 Hz (1.17 Hz) and 1 more:"), (8, " and 3 more:")]
    )
    def test_many(self, count, ending):
        (said,) = self.said([1.0] * count, 0.4)
        assert f"{ending} the height" in said

    def test_nothing_above_what_can_be_used(self):
        (said,) = self.said([1.0, 1.0], 0.4, usable_up_to=15.0)
        assert "at 10 Hz (1.17 Hz):" in said
        (said,) = self.said([1.0], 0.4, usable_up_to=15.0)
        assert "at 10 Hz" in said

    def test_also_of_the_first_lines(self):
        """A peak between 0 and 1 Hz counts."""
        f = np.arange(0, 3, 0.1)
        values = np.maximum(0.1, 1 - abs(f - 0.5) / 0.4)
        (said,) = peak_warnings(response(values, f=f, usable_up_to=2.0), 0.4)
        assert "at 0.5 Hz" in said

    def test_doubtful(self):
        """What is incoherent is not called narrow as well."""
        said = self.said([1.0, 1.0, 1.0], 0.4, [0.9, 0.79, 0.8])
        assert [text.split(" at ")[1].split(":")[0] for text in said] == [
            "10 Hz (1.17 Hz), 30 Hz (1.17 Hz)",
            "the peak",
        ]
        assert said[1] == "warning: phi/T coherence under 0.8 at the peak at 20 Hz (0.79)"

    def test_every_pair(self):
        f, values = towers([1.0])
        both = np.stack([values, np.full(len(f), 0.1)], axis=1)[:, :, None] * np.ones((1, 1, 2))
        channels = (Channel("a", "rad"), Channel("b", "rad")), (Channel("T", "N*m"), Channel("U", "N*m"))
        said = peak_warnings(FrequencyResponse(f, both.astype(complex), *channels), 0.4)
        assert [str(text).split()[1] for text in said] == ["a/T", "a/U"]
