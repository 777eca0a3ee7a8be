"""Dates and times of day as the time stamps of text files: seconds from the first, or a message with its place."""

import json
from datetime import datetime, timedelta

import numpy as np
import pytest
from support.command_line import run

from torsionnet.base.delimited.number_rows import StampReader
from torsionnet.base.errors import ModelError
from torsionnet.base.notes import warning
from torsionnet.signals.records.clock import rounded_grid
from torsionnet.signals.records.recording_files import iter_blocks, read_recording
from torsionnet.signals.resampling import gaps, jitter

COUNT = 3000
BEGIN = datetime.fromisoformat("2024-05-03T10:12:13.001")
VALUES = np.round(np.sin(np.arange(COUNT)), 4)
FORMS = {
    "ISO": "%Y-%m-%dT%H:%M:%S.%f",
    "ISO with a blank": "%Y-%m-%d %H:%M:%S.%f",
    "ISO in UTC": "%Y-%m-%dT%H:%M:%S.%fZ",
    "with an offset": "%Y-%m-%d %H:%M:%S.%f+02:00",
    "slashes": "%Y/%m/%d %H:%M:%S.%f",
    "German": "%d.%m.%Y %H:%M:%S,%f",
    "either": "%d/%m/%Y %H:%M:%S.%f",
    "American": "%m/%d/%Y %I:%M:%S.%f %p",
    "clock": "%H:%M:%S.%f",
}


def texts(form, begin=BEGIN, step=0.001, count=COUNT):
    return [(begin + timedelta(microseconds=round(1e6 * step * at))).strftime(form) for at in range(count)]


def write(tmp_path, stamps, separator=";", heading="time{0}T [Nm]{0}phi [deg]", decimal="."):
    lines = [heading.format(separator)] if heading else []
    for stamp, value in zip(stamps, np.resize(VALUES, len(stamps)), strict=True):
        lines.append(separator.join([stamp, f"{value:.4f}".replace(".", decimal), "1"]))
    path = tmp_path / "r.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


class TestForms:
    @pytest.mark.few(5)
    @pytest.mark.parametrize("form", FORMS)
    @pytest.mark.parametrize("separator", [";", "\t"])
    def test_seconds_from_the_first_stamp(self, tmp_path, form, separator):
        stamps = texts(FORMS[form])
        found = read_recording(write(tmp_path, stamps, separator))
        assert (found.names, found.sampling_rate, found.start, len(found)) == (("T", "phi"), 1000.0, 0.0, COUNT)
        assert found.times is None
        np.testing.assert_array_equal(found["T"].values, VALUES)
        assert f"time counts from the first stamp, {stamps[0]}" in found.notes
        assert '"time" was taken for the time stamps' in found.notes
        assert not any("warning" in note for note in found.notes)

    @pytest.mark.parametrize("form", ["ISO", "ISO with a blank", "clock"])
    @pytest.mark.parametrize("heading", ["", "time,T [Nm],phi [deg]"])
    def test_between_commas_with_and_without_a_heading(self, tmp_path, form, heading):
        found = read_recording(write(tmp_path, texts(FORMS[form]), ",", heading))
        assert found.sampling_rate == 1000.0
        np.testing.assert_array_equal(found.signals[0].values, VALUES)

    def test_decimal_commas_beside_them(self, tmp_path):
        found = read_recording(write(tmp_path, texts(FORMS["German"]), decimal=","))
        np.testing.assert_array_equal(found["T"].values, VALUES)

    @pytest.mark.parametrize("heading", ["date{0}time{0}T[Nm]{0}phi[deg]", "time{0}T[Nm]{0}phi[deg]"])
    def test_date_and_time_between_white_space(self, tmp_path, heading):
        found = read_recording(write(tmp_path, texts("%Y-%m-%d %H:%M:%S.%f"), " ", heading))
        assert (found.names, found.sampling_rate) == (("T", "phi"), 1000.0)
        assert "time counts from the first stamp, 2024-05-03 10:12:13.001000" in found.notes

    def test_date_and_time_in_columns_of_their_own(self, tmp_path):
        stamps = [stamp.replace(" ", ";") for stamp in texts(FORMS["ISO with a blank"])]
        found = read_recording(write(tmp_path, stamps, heading="Datum;Uhrzeit;T [Nm];phi [deg]"))
        assert (found.names, found.sampling_rate) == (("T", "phi"), 1000.0)
        assert '"Datum Uhrzeit" was taken for the time stamps' in found.notes

    def test_in_quotes(self, tmp_path):
        stamps = [f'"{stamp}"' for stamp in texts(FORMS["German"], count=200)]
        assert read_recording(write(tmp_path, stamps, ",")).sampling_rate == 1000.0

    def test_fractions_that_are_left_out_where_they_are_zero(self, tmp_path):
        stamps = [(BEGIN + timedelta(milliseconds=at)).isoformat() for at in range(COUNT)]
        assert any("." not in stamp for stamp in stamps)
        assert read_recording(write(tmp_path, stamps)).sampling_rate == 1000.0

    def test_uneven_ones_are_kept(self, tmp_path):
        steps = np.cumsum(np.random.default_rng(1).integers(500, 1500, 100))
        stamps = [(BEGIN + timedelta(microseconds=int(at))).isoformat(timespec="microseconds") for at in steps]
        found = read_recording(write(tmp_path, stamps))
        assert found.times == pytest.approx((steps - steps[0]) * 1e-6, abs=1e-12)

    def test_in_blocks(self, tmp_path):
        blocks = list(iter_blocks(write(tmp_path, texts(FORMS["ISO"])), 1.0))
        assert [len(block) for block in blocks] == [1000, 1000, 1000]
        assert [block.start for block in blocks] == pytest.approx([0, 1, 2])

    def test_a_column_of_numbers_for_the_time_is_finer(self, tmp_path):
        rows = "".join(f"2024-05-03 10:12:{13 + at // 100};{at / 100};{at}\n" for at in range(300))
        path = tmp_path / "r.csv"
        path.write_text("stamp;t [s];T [Nm]\n" + rows)
        found = read_recording(path)
        assert (found.names, found.sampling_rate) == (("T",), 100.0)
        assert '"stamp" holds dates and times of day, and was left out' in found.notes


class TestMidnight:
    NIGHT = datetime.fromisoformat("2024-02-28T23:59:59")

    @pytest.mark.few(4)
    @pytest.mark.parametrize("form", ["clock", "ISO", "German", "with an offset"])
    @pytest.mark.parametrize("seconds", [None, 0.7])
    def test_is_passed(self, tmp_path, form, seconds):
        path = write(tmp_path, texts(FORMS[form], self.NIGHT))
        records = [read_recording(path)] if seconds is None else list(iter_blocks(path, seconds))
        assert {record.sampling_rate for record in records} == {1000.0}
        assert np.concatenate([record.time for record in records]) == pytest.approx(np.arange(COUNT) / 1000)

    def test_by_clocks_read_one_by_one(self):
        reader = StampReader()
        first, none = reader.seconds(["11:59:59.5 PM", "12:00:00 AM"])
        second, _ = reader.seconds(["12:00:00.5 AM", "1:00:00 AM"])
        assert (first.tolist(), second.tolist(), none) == ([0, 0.5], [1, 3600.5], [])

    def test_summer_time_ends(self):
        """Both are one second after the other in UTC."""
        found, _ = StampReader().seconds(["2024-10-27T02:59:59.5+02:00", "2024-10-27T02:00:00.5+01:00"])
        assert found.tolist() == [0, 1]

    def test_day_or_month_first_where_a_number_tells(self, tmp_path):
        for form in ("%d/%m/%Y %H:%M:%S.%f", "%m/%d/%Y %H:%M:%S.%f"):
            path = write(tmp_path, texts(form, datetime.fromisoformat("2024-05-30T23:59:59")))
            assert read_recording(path).sampling_rate == 1000.0

    def test_day_or_month_first_where_none_tells(self, tmp_path):
        path = write(tmp_path, texts(FORMS["either"], datetime.fromisoformat("2024-05-03T23:59:59")))
        with pytest.raises(ModelError, match=r":1002:1: .*03.*05.*not-a-number"):
            read_recording(path)


def other(at, text):
    stamps = texts(FORMS["ISO"], count=50)
    stamps[at] = text
    return stamps


FAULTS = {
    "another form": (other(20, "03.05.2024 10:12:13,021"), r":22:1: .*03\.05.*10.*not-a-number"),
    "a blank for T": (other(20, "2024-05-03 10:12:13.021"), r":22:1: .*not-a-number"),
    "a zone": (other(20, "2024-05-03T10:12:13.021Z"), "is written otherwise"),
    "a comma": (other(20, "2024-05-03T10:12:13,021"), "is written otherwise"),
    "a clock": (other(20, "10:12:13.021"), "is written otherwise"),
    "no such time": (other(20, "2024-05-03T10:72:13.021"), r":22:1: .*2024.*05.*not-a-number"),
    "no such day": (other(20, "2024-02-30T10:12:13.021"), r":22:1: .*2024.*02.*not-a-number"),
    "a number": (other(20, "0.021"), r":22:1: .*0\.021.*not-a-number"),
    "none": (other(20, ""), r":22:1: .*21.*not-finite"),
    "back": (other(20, "2024-05-03T10:12:13.003"), "time has to increase"),
    "whole seconds": (texts("%d.%m.%Y %H:%M:%S"), r":3:1: .*2996.*3000.*unordered-rows"),
    "one second": (texts("%H:%M:%S", count=500), r":3:1: .*499.*500.*unordered-rows"),
    "ms at 3 kHz": ([stamp[:-3] for stamp in texts(FORMS["ISO"], step=1 / 3000)], r":3:1: .*0\.001.*unordered-rows"),
}  # fmt: skip


@pytest.mark.parametrize("case", FAULTS)
def test_faults_have_their_place(tmp_path, case):
    stamps, message = FAULTS[case]
    with pytest.raises(ModelError, match=message):
        read_recording(write(tmp_path, stamps))


def test_far_down_in_the_file(tmp_path):
    """Beyond what is looked at first, and beyond the first rows that are parsed at once."""
    stamps = texts(FORMS["ISO"], count=21_000)
    stamps[20_500] = "03.05.2024 10:12:34,001"
    with pytest.raises(ModelError, match=r":20502:1: .*not-a-number"):
        read_recording(write(tmp_path, stamps))


class TestCoarse:
    def test_a_rate_given_that_agrees_is_taken(self, tmp_path):
        path = write(tmp_path, texts("%d.%m.%Y %H:%M:%S"))
        found = read_recording(path, sampling_rate=1000.0)
        assert (found.sampling_rate, found.start, found.times) == (1000.0, 0.0, None)
        assert warning("the time stamps are coarser than the sampling: the rate given was taken") in found.notes
        assert [block.start for block in iter_blocks(path, 1.0, sampling_rate=1000.0)] == pytest.approx([0, 1, 2])
        with pytest.raises(ModelError, match=r"(?s)100.*contradicting-values"):
            read_recording(path, sampling_rate=100.0)

    def test_numbers_too(self, tmp_path):
        path = write(tmp_path, [f"{at / 1000:.2f}" for at in range(COUNT)])
        with pytest.raises(ModelError, match=r":3:1: .*0\.01.*unordered-rows"):
            read_recording(path)

    def test_one_sample_twice_is_another_fault(self, tmp_path):
        stamps = texts(FORMS["ISO"], count=300)
        stamps[100] = stamps[99]
        with pytest.raises(ModelError, match=r":102:1: .*0\.099.*0\.099.*unordered-rows"):
            read_recording(write(tmp_path, stamps))

    def test_exit_code(self, tmp_path):
        path = write(tmp_path, texts("%H:%M:%S"))
        result = run("estimate", path, "--input", "T", "--output", "phi", code=1)
        assert "r.csv:3:1: error: 2996" in result.stderr


def digits(form, rate, count=3000, start=0.0):
    """Times in s, each written with some digits and read again."""
    return np.array([float(format(at, form)) for at in start + np.arange(count) / rate])


ROUNDED = {
    "6 decimals": (digits(".6f", 25.6e3), 25.6e3, 1.0),
    "6 decimals at an odd rate": (digits(".6f", 25.6e3 + 0.37), 25.6e3 + 0.37, 1.0),
    "3 decimals of ms": (digits(".3f", 25.6), 25.6e3, 1e-3),
    "few": (digits(".6f", 25.6e3, count=20), 25.6e3, 1.0),
    "cut, not rounded": (np.floor(np.arange(3000) / 25.6e3 * 1e6) / 1e6, 25.6e3, 1.0),
    "ties": (digits(".5f", 12.8e3, start=99.5), 12.8e3, 1.0),
    "an interval in round figures": (digits(".5f", 1 / 3.5e-5, start=5), 1 / 3.5e-5, 1.0),
    "7 significant digits": (digits(".6e", 2.8e3, start=99.5), 2.8e3, 1.0),
    "single precision": (np.float32(1500 + np.arange(3000) / 1000), 1000.0, 1.0),
    "single precision as text": (np.array([float(str(np.float32(at))) for at in 700 + np.arange(3000) / 1100]), 1100.0, 1.0),
    "days in double precision": (738_000.3 + np.arange(3000) / 25.6e3 / 86_400, 25.6e3, 86_400.0),
}  # fmt: skip


class TestRounded:
    @pytest.mark.parametrize("case", ROUNDED)
    def test_are_the_grid_that_they_were_rounded_from(self, case):
        stamps, rate, scale = ROUNDED[case]
        stamps = np.asarray(stamps, dtype=float)
        assert jitter(stamps) > 0.004
        found = rounded_grid(stamps, scale)
        assert found.rate == pytest.approx(rate, rel=1e-12)
        unit = 2 * np.max(np.abs(np.diff(stamps) * scale - 1 / rate))
        assert found.start == pytest.approx(stamps[0] * scale, abs=unit, rel=1e-15)

    def test_of_long_records_in_single_precision(self, tmp_path):
        """They rise by 0.98 or 1.22 ms from 2048 s on."""
        path = tmp_path / "r.npz"
        np.savez(path, t=np.float32(np.arange(2_500_000) / 1000), T=np.zeros(2_500_000))
        found = read_recording(path)
        assert (found.sampling_rate, found.start, found.times) == (1000.0, 0.0, None)
        assert any("rounded (single precision)" in note for note in found.notes)

    @pytest.mark.parametrize("interval", [3e-4, 7e-5, 3.0, 1.1])
    def test_stamps_that_are_even_are_no_rounded_ones(self, tmp_path, interval):
        found = read_recording(write(tmp_path, [f"{at * interval:.7g}" for at in range(3000)]))
        assert found.sampling_rate == pytest.approx(1 / interval, rel=1e-12)
        assert found.times is None

    def test_equal_ones_need_others_finer_than_the_sampling(self):
        assert rounded_grid(digits(".3g", 200.0)).rate == 200.0
        assert rounded_grid(digits(".2f", 200.0)) is None

    def test_a_fit_says_which_stamps_are_on_a_grid(self):
        """By linear programming, where drift and jitter of about half a unit leave a grid, or none."""
        from scipy.optimize import linprog

        random, number, verdicts = np.random.default_rng(3), np.arange(60), []
        for amount in np.linspace(0, 0.4, 24):
            away = random.normal(size=60) * amount if len(verdicts) % 2 else amount * (number / 30 - 1) ** 2
            stamps = np.round(number * random.uniform(2, 7) + away)
            bounds = np.column_stack([np.ones(60), number])
            matrix, most = np.vstack([bounds, -bounds]), np.concatenate([stamps + 0.5, 0.5 - stamps])
            fits = linprog([0, 0], A_ub=matrix, b_ub=most, bounds=[(None, None)] * 2).status == 0
            verdicts.append(fits)
            assert (rounded_grid(stamps) is not None) == fits
        assert {*verdicts} == {True, False}

    @pytest.mark.parametrize("away", [
        lambda at: 1.5e-6 * np.sin(at / 7), lambda at: 3e-6 * (at / 3000) ** 2, lambda at: 2e-6 * (at > 1700),
    ], ids=["jitter", "drift", "a lost microsecond"])  # fmt: skip
    @pytest.mark.parametrize("form", [".6f", ".17g"])
    def test_jitter_and_drift_stay(self, tmp_path, away, form):
        at = np.arange(3000)
        stamps = [format(time, form) for time in at / 25.6e3 + away(at)]
        found = read_recording(write(tmp_path, stamps))
        assert found.times == pytest.approx([float(stamp) for stamp in stamps], abs=1e-15)

    def test_a_gap_is_no_matter_of_arguments_on_the_command_line(self, tmp_path):
        at = np.delete(np.arange(3000), np.s_[1000:1300])
        path = write(tmp_path, [f"{time:.6f}" for time in at / 25.6e3])
        given = "--input", "T", "--output", "phi", "--seconds", "0.01"
        assert "1 gap in the time stamps" in run("estimate", path, *given, code=1).stderr
        said = run("estimate", path, *given, "--resample", code=2).stderr
        assert "cannot resample across 1 gaps" in said
        assert "bridge_gaps" not in said

    def test_estimates_as_exact_ones_do(self, tmp_path):
        random = np.random.default_rng(0)
        torque, angle = random.normal(size=(2, 60_000))
        estimates = []
        for form in (".6f", ".17g"):
            rows = zip(np.arange(60_000) / 25.6e3, torque, angle, strict=True)
            path = tmp_path / "r.csv"
            path.write_text("t [s],T [Nm],a [rad]\n" + "".join(f"{t:{form}},{x},{y}\n" for t, x, y in rows))
            result = run("estimate", path, "--input", "T", "--output", "a", "--seconds", "0.1", "--json")
            found = json.loads(result.stdout)
            remark = "the time stamps are rounded (6 decimals) and were taken for uniform sampling at 25600 Hz"
            assert (remark in found.pop("notes")) == (form == ".6f")
            estimates.append(found)
        assert estimates[0] == estimates[1]


@pytest.mark.parametrize("form", [form for form in FORMS if form != "American"])
def test_quickly_and_one_by_one_the_same(form):
    stamps = texts(FORMS[form], count=200)
    quick, slow = StampReader(), StampReader()
    quick.seconds(stamps[:1]), slow.seconds(stamps[:1])
    assert quick._alike(stamps) is not None
    one_by_one = np.concatenate([slow.seconds([stamp, ""])[0][:1] for stamp in stamps])
    np.testing.assert_array_equal(quick.seconds(stamps)[0], one_by_one)


def test_a_single_stamp_has_neither_gap_nor_jitter():
    assert (gaps(np.array([1.0])).tolist(), jitter(np.array([1.0]))) == ([], 0.0)
