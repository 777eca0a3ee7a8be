"""Every channel of a file has a clock of its own: rate, start and axis as the library of the format writes them."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support.command_line import run

from torsionnet.base.errors import ModelError
from torsionnet.base.notes import warning
from torsionnet.signals import iter_blocks, read_recording

RATE = 1000.0
TIMES = np.arange(4000) / RATE


def torque(times):
    """Torque in N m at these times in s on the common clock; no two stretches of it are equal."""
    return 10 * np.sin(2 * np.pi * 20 * times) + times


def speed(times):
    """Angular velocity in rad/s at these times in s on the common clock."""
    return 2 * np.cos(2 * np.pi * 7 * times) - times


def is_on_one_clock(record, torque_name="T", speed_name="w", within=1e-9):
    assert np.abs(record[torque_name].values - torque(record.time)).max() < within
    assert np.abs(record[speed_name].values - speed(record.time)).max() < within


def refusal(path, **options):
    with pytest.raises(ModelError) as caught:
        read_recording(path, **options)
    return str(caught.value)


class TestTdms:
    @pytest.fixture
    def written(self, tmp_path):
        nptdms = pytest.importorskip("nptdms")

        def write(*channels):
            path = tmp_path / "run.tdms"
            with nptdms.TdmsWriter(str(path)) as writer:
                writer.write_segment([nptdms.ChannelObject("g", *channel) for channel in channels])
            return path

        return write

    def wave(self, unit, begun=0.0, rate=RATE, **more):
        known = {
            "wf_start_time": np.datetime64("2024-05-03T10:12:13.000000") + np.timedelta64(round(1e6 * begun), "us")
        }
        return {"wf_increment": 1 / rate, "unit_string": unit, **known, **more}

    @pytest.mark.parametrize(("begun", "offset"), [(0.25, 0.0), (3.0, 0.0), (-0.75, 0.0), (0.5, 0.1)])
    def test_starts_whole_samples_apart_are_cut_and_told(self, written, begun, offset):
        later = self.wave("rad/s", begun, wf_start_offset=offset)
        start = begun + offset
        path = written(("T", torque(TIMES), self.wave("N*m")), ("w", speed(TIMES + start), later))
        found = read_recording(path)
        zero = max(0.0, -start)  # seconds count from the earliest start
        assert found.start == pytest.approx(max(0.0, start) + zero)
        assert len(found) == 4000 - round(abs(start) * RATE)
        assert np.abs(found["T"].values - torque(found.time - zero)).max() < 1e-9
        assert np.abs(found["w"].values - speed(found.time - zero)).max() < 1e-9
        assert sum(note.startswith("cut to where all channels were recorded, from") for note in found.notes) == 1
        blocks = list(iter_blocks(path, 0.1))
        assert np.array_equal(np.concatenate([block["w"].values for block in blocks]), found["w"].values)

    def test_a_large_file_tells_its_notes_once(self, written, monkeypatch):
        from torsionnet.signals.records import recording_files as large_records

        path = written(("T", torque(TIMES), self.wave("N*m")), ("w", speed(TIMES + 0.25), self.wave("rad/s", 0.25)))
        monkeypatch.setattr(large_records, "LARGE_FILE", 1000)
        monkeypatch.setattr(large_records, "BLOCK_SECONDS", 1.5)
        found = run("estimate", path, "--input", "T", "--output", "w", "--seconds", "0.5")
        assert "read in blocks of 1.5 s" in found.stderr
        assert found.stderr.count("note: cut to where all channels were recorded, from 0.25 to 3.999 s") == 1

    def test_a_start_of_its_own_is_that_of_a_channel_read_alone(self, written):
        path = written(("T", torque(TIMES), self.wave("N*m")), ("w", speed(TIMES), self.wave("rad/s", 0.25)))
        assert read_recording(path, names=["w"]).start == 0.25

    def test_starts_in_whole_microseconds(self, written):
        """100 samples at 51.2 kHz are 1953.125 us, which the library cuts to 1953 us: 0.006 samples."""
        quick = np.arange(2000) / 51200
        late = self.wave("rad/s", 100 / 51200, 51200)
        path = written(("T", torque(quick), self.wave("N*m", rate=51200)), ("w", speed(quick), late))
        assert len(read_recording(path)) == 1900

    def test_starts_parts_of_a_sample_apart(self, written):
        late = self.wave("rad/s", 0.2504)
        path = written(("T", torque(TIMES), self.wave("N*m")), ("w", speed(TIMES + 0.2504), late))
        assert re.search(r"0 s\), w.*0\.2504 s.*resample=True.*unlike-results", refusal(path))
        found = read_recording(path, resample=True)
        is_on_one_clock(found.between(0.5, 3.5), within=2e-3)
        assert any(
            "w: interpolated from 1000 to 1000 Hz, band-limited: holds up to 400 Hz" in note for note in found.notes
        )

    def test_no_time_in_common(self, written):
        path = written(("T", TIMES, self.wave("N*m")), ("w", TIMES, self.wave("rad/s", 4.0)))
        assert re.search(r"0 s\), w.* 4 s\).*unlike-results", refusal(path))

    def test_an_axis_that_is_no_time(self, written):
        angle = self.wave("N*m", wf_xunit_string="deg")
        assert re.search(r"channels\.T: .* deg.*wrong-file", refusal(written(("T", TIMES, angle))))
        path = written(("T", TIMES, angle), ("w", speed(TIMES), self.wave("rad/s")))
        found = read_recording(path)
        assert found.names == ("w",)
        assert "left out, as they are no records over time: T (over deg)" in found.notes
        assert re.search(r"channels\.T: .* deg.*wrong-file", refusal(path, names=["T", "w"]))

    def test_channels_without_a_clock_or_a_start_are_said(self, written):
        started, bare = self.wave("N*m"), {"wf_increment": 1e-3, "unit_string": "rad/s"}
        found = read_recording(written(("T", torque(TIMES), started), ("w", speed(TIMES), bare)))
        assert "channels without wf_start_time were taken to begin with the first of the others" in found.notes
        found = read_recording(written(("T", torque(TIMES), started), ("w", speed(TIMES), {"unit_string": "rad/s"})))
        assert "w: no clock in the file, taken to be sampled with the others" in found.notes

    def test_an_axis_in_ms(self, written):
        found = read_recording(written(("T", TIMES, {**self.wave("N*m", rate=1.0), "wf_xunit_string": "ms"})))
        assert found.sampling_rate == RATE

    def test_a_rate_other_than_that_of_the_file(self, written):
        path = written(("T", TIMES, self.wave("N*m")))
        assert re.search(r"T \(1000 Hz.*sampling_rate=2000.*contradicting-values", refusal(path, sampling_rate=2000))


class TestPulsesBesideOtherRates:
    """The signal of 12 teeth at 5 kHz beside a torque of 1 kHz that began 50 ms later, and one of 500 Hz."""

    FAST = np.arange(20000) / 5000

    def angle(self, times):
        """Angle in rad of the shaft, at 600 rpm with a vibration by which a shift of the clock shows."""
        return 2 * np.pi * 10 * times + 0.5 * np.sin(2 * np.pi * times)

    @pytest.fixture
    def file(self, tmp_path):
        nptdms = pytest.importorskip("nptdms")
        begin = np.datetime64("2024-05-03T10:12:13.000000")
        teeth = 5.0 * ((self.angle(self.FAST) * 12 / 2 / np.pi) % 1 < 0.5)
        late, slow = TIMES[:3950] + 0.05, np.arange(2000) / 500
        wave = {"unit_string": "N*m", "wf_start_time": begin}
        with nptdms.TdmsWriter(str(tmp_path / "run.tdms")) as writer:
            writer.write_segment([
                nptdms.ChannelObject("g", "p", teeth, {**wave, "unit_string": "V", "wf_increment": 1 / 5000}),
                nptdms.ChannelObject(
                    "g", "T", torque(late), {**wave, "wf_increment": 0.001, "wf_start_time": begin + np.timedelta64(50, "ms")}
                ),
                nptdms.ChannelObject("g", "x", torque(slow), {**wave, "wf_increment": 0.002}),
            ])  # fmt: skip
        return tmp_path / "run.tdms"

    def is_right(self, found, angle):
        assert np.abs(found["T"].values - torque(found.time)).max() < 2e-3
        assert np.ptp(found[angle].values - self.angle(found.time)) < 3 * 2 * np.pi * 10 / 5000

    def test_a_rate_chosen_for_the_others_is_none_of_the_teeth(self, file):
        assert re.search(r"500 Hz.*\(x\); 1000 Hz.*\(T\).*unlike-results", refusal(file, pulses={"p": 12}))
        for chosen in ({"sampling_rate": 1000}, {"sampling_rate": 1000, "resample": True}, {"names": ["T", "p"]}):
            found = read_recording(file, pulses={"p": 12}, **chosen)
            assert (found.sampling_rate, "x" in found.names) == (1000, "resample" in chosen)
            self.is_right(found.between(0.1, 3.9), "p")

    def test_angle_keeps_a_channel_of_another_rate_resampled(self, file, tmp_path):
        given = "angle", file, "--pulses", "p=12", "--channel", "T"
        refused = run(*given, code=1).stderr
        assert re.search(r"1000 Hz.*\(T\); 5000 Hz.*\(p\).*--resample.*unlike-results", refused)
        run(*given, "--resample", "-o", tmp_path / "angle.npz")
        found = read_recording(tmp_path / "angle.npz")
        assert any("T: interpolated from 1000 to 5000 Hz" in note for note in found.notes)
        self.is_right(found.between(0.5, 3.5), "p angle")

    def test_angle_makes_uneven_time_stamps_even(self, tmp_path):
        stamps = np.round(TIMES + 1e-4 * np.sin(np.arange(4000)), 6)
        pulses = np.arange(480) / 120 + 0.001
        np.savez(tmp_path / "run.npz", t=stamps, T=torque(stamps), p=pulses)
        given = ["--pulses", "p=12", "--channel", "T", "--quantity", "T=torque"]
        for option in ([], ["--resample"]):
            run("angle", tmp_path / "run.npz", *given, "-o", tmp_path / "angle.npz", *option)
            found = read_recording(tmp_path / "angle.npz")
            assert (found.times is None) == bool(option)
            assert any("by cubic splines" in note for note in found.notes) == bool(option)


class TestMdf:
    @pytest.fixture
    def written(self, tmp_path):
        asammdf = pytest.importorskip("asammdf")

        def write(*groups, **common):
            """Write a file of a group for each of (name, values, stamps, unit), with its comment."""
            path = tmp_path / "run.mf4"
            with asammdf.MDF(version="4.10") as file:
                for name, values, stamps, unit, comment, *more in groups:
                    signal = asammdf.Signal(values, stamps, unit, name, **common, **dict(more))
                    file.append([signal], comment=comment)
                file.save(path, overwrite=True)
            return path

        return write

    def test_rasters_are_read_one_by_one_or_resampled(self, written):
        slow = np.arange(4000) / 500
        path = written(
            ("T", torque(TIMES), TIMES, "N*m", "1 ms"),
            ("w", speed(slow), slow, "rad/s", "2 ms"),
            ("phi", speed(slow), slow, "rad", "2 ms"),
        )
        assert re.search(r"500 Hz.*\(w, phi\); 1000 Hz.*\(T\); sampling_rate=.*unlike-results", refusal(path))
        found = read_recording(path, names=["w", "phi"])
        assert (found.sampling_rate, found.duration) == (500.0, 8.0)
        assert np.array_equal(found["w"].values, speed(slow))
        found = read_recording(path, sampling_rate=1000, resample=True)
        is_on_one_clock(found.between(0.5, 3.5), within=2e-3)
        blocks = list(iter_blocks(path, 1.0, names=["T", "w"], sampling_rate=1000, resample=True))
        # Half-way between two samples rounding decides which of them the filter of -80 dB is centred on.
        assert np.abs(np.concatenate([one["w"].values for one in blocks]) - found["w"].values).max() < 2e-4

    @pytest.mark.parametrize("begun", [0.25, 3.0])
    def test_a_group_that_begins_later(self, written, begun):
        path = written(
            ("T", torque(TIMES), TIMES, "N*m", ""),
            ("w", speed(TIMES + begun), TIMES + begun, "rad/s", ""),
        )
        found = read_recording(path)
        assert (found.start, len(found)) == (begun, 4000 - round(1000 * begun))
        is_on_one_clock(found)

    def test_single_samples_beside_records(self, written):
        gear = ("gear", np.array([3.0]), TIMES[:1], "", "")
        found = read_recording(written(("T", torque(TIMES), TIMES, "N*m", ""), gear))
        assert (found.names, found.sampling_rate) == (("T",), RATE)
        assert "left out, as they are single samples: gear" in found.notes
        assert "[missing-entry]" in refusal(written(gear))

    def test_uneven_stamps(self, written):
        """A bus sends about every 10 ms; its channels are read by themselves, or through splines to the even raster."""
        uneven = np.sort(np.arange(400) / 100 + np.random.default_rng(1).uniform(-2e-3, 2e-3, 400))
        path = written(("T", torque(TIMES), TIMES, "N*m", ""), ("w", speed(uneven), uneven, "rad/s", ""))
        alone = read_recording(path, names=["w"])
        assert np.array_equal(alone.times, uneven)
        found = read_recording(path, sampling_rate=1000, resample=True)
        is_on_one_clock(found.between(0.5, 3.5), within=2e-2)
        assert any(
            note.startswith("w: resampled to 100.") and "with errors up to about" in note for note in found.notes
        )

    def test_equal_names(self, written):
        path = written(
            ("T", torque(TIMES), TIMES, "N*m", "bench"),
            ("T", 2 * torque(TIMES), TIMES, "N*m", "telemetry"),
            ("w", speed(TIMES), TIMES, "rad/s", "bench"),
        )
        found = read_recording(path)
        assert found.names == ("group 1/T", "telemetry/T", "w")
        assert np.array_equal(found["telemetry/T"].values, 2 * found["group 1/T"].values)
        assert re.search("group 1/T, telemetry/T.*unknown-channel", refusal(path, names=["T"]))

    def test_stamps_that_are_off_by_little_are_one_raster(self, written):
        """Loggers stamp each group by itself: rates and starts differ by what even stamps may be off."""
        random = np.random.default_rng(1)
        first, second = (TIMES + random.uniform(-3e-6, 3e-6, 4000) for _ in range(2))
        path = written(("T", torque(TIMES), first, "N*m", ""), ("w", speed(TIMES), second, "rad/s", ""))
        found = read_recording(path)
        assert (len(found), found.times) == (4000, None)
        assert found.sampling_rate == pytest.approx(RATE, rel=1e-5)

    @pytest.mark.parametrize(("kind", "word"), [(2, "an angle"), (3, "a distance"), (4, "an index")])
    def test_a_master_that_is_no_time(self, written, kind, word):
        path = written(("T", torque(TIMES), 0.36 * np.arange(4000), "N*m", ""), master_metadata=("master", kind))
        assert re.search(f"{word} in .*wrong-file", refusal(path))

    def test_samples_marked_invalid_are_missing(self, written):
        invalid = (TIMES >= 1) & (TIMES < 1.4)
        path = written(("T", torque(TIMES), TIMES, "N*m", "", ("invalidation_bits", invalid)))
        found = read_recording(path)
        assert np.array_equal(np.isnan(found["T"].values), invalid)
        assert np.array_equal(found["T"].values[~invalid], torque(TIMES)[~invalid])
        assert "samples that the file marks as invalid are missing, as NaN: T (400)" in found.notes


CODES = {
    f"{axis}_{entry}": 0
    for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
    for entry in ("spec_data_type", "len_unit_exp", "force_unit_exp", "temp_unit_exp")
    if (axis, entry) != ("abscissa", "spec_data_type")
} | {"z_axis_axis_units_lab": "NONE"}
"""Entries of a dataset 58 that the library wants, though they say nothing here."""


class TestUff:
    @pytest.fixture
    def written(self, tmp_path):
        pyuff = pytest.importorskip("pyuff")

        def write(*sets):
            path = tmp_path / "run.uff"
            for entries in sets:
                pyuff.UFF(str(path)).write_sets(entries, mode="add")
            return path

        return write

    def function(self, name, values, abscissa, label, axis="s", kind=1, **more):
        import pyuff

        entries = pyuff.prepare_58(
            binary=0, func_type=kind, id1=name, data=values, x=abscissa, rsp_node=1, rsp_dir=4, ref_node=1, ref_dir=4,
            abscissa_spacing=1, abscissa_min=float(abscissa[0]), abscissa_inc=float(abscissa[1] - abscissa[0]),
            abscissa_axis_units_lab=axis, ordinate_axis_units_lab=label, orddenom_axis_units_lab="NONE",
        )  # fmt: skip
        return {**entries, "abscissa_spec_data_type": 17 if kind == 1 else 18, **CODES, **more}

    def test_sets_of_other_rates_and_starts(self, written):
        slow = np.arange(2000) / 500
        other = written(self.function("T", torque(TIMES), TIMES, "N*m"), self.function("w", speed(slow), slow, "rad/s"))
        assert re.search(r"500 Hz.*\(w\); 1000 Hz.*\(T\).*unlike-results", refusal(other))
        assert read_recording(other, names=["w"]).sampling_rate == 500
        is_on_one_clock(read_recording(other, sampling_rate=1000, resample=True).between(0.5, 3.4), within=2e-3)

    def test_sets_that_begin_at_other_times(self, written):
        late = TIMES + 0.25
        path = written(self.function("T", torque(TIMES), TIMES, "N*m"), self.function("w", speed(late), late, "rad/s"))
        found = read_recording(path)
        assert (found.start, len(found)) == (0.25, 3750)
        is_on_one_clock(found, within=1e-8)

    def test_the_unit_of_the_abscissa(self, written):
        path = written(self.function("T", torque(TIMES), 1000 * TIMES, "N*m", "ms"))
        found = read_recording(path)
        assert (found.sampling_rate, found.duration) == (RATE, 4.0)

    def test_an_abscissa_named_as_no_time(self, written):
        axis = {"abscissa_axis_lab": "Order", "abscissa_spec_data_type": 0}
        assert "over Order" in refusal(written(self.function("T", torque(TIMES), TIMES, "N*m", "NONE", **axis)))

    @pytest.mark.parametrize("axis", ["rev", "rad/s", "rpm"])
    def test_an_abscissa_that_is_no_time(self, written, axis):
        refused = refusal(written(self.function("T", torque(TIMES), TIMES, "N*m", axis)))
        assert re.search(f"over {axis}, .*wrong-file", refused)

    def test_spectra_beside_records_are_named(self, written):
        spectrum = self.function("T", np.arange(9.0), np.arange(9.0), "N*m", "Hz", 2)
        record = self.function("T", torque(TIMES), TIMES, "N*m")
        assert not any("left out" in note for note in read_recording(written(record)).notes)
        notes = read_recording(written(spectrum, spectrum)).notes
        assert "left out, as no records over time: 2 auto spectra (data set 58)" in notes

    def test_equal_names(self, written):
        first = self.function("Time response", torque(TIMES), TIMES, "N*m")
        second = {**self.function("Time response", speed(TIMES), TIMES, "rad/s"), "rsp_node": 2}
        assert read_recording(written(first, second)).names == ("Time response NONE1:4", "Time response NONE2:4")

    @pytest.mark.parametrize(("axis", "factor"), [("rad/s", 2 * np.pi), ("rpm", 60.0), ("kHz", 1e-3), ("Hz", 1.0)])
    def test_frequencies_of_a_response(self, written, axis, factor):
        from torsionnet.io import read_frequency_response

        lines = np.arange(1, 41) * 0.5
        entries = self.function("theta / T", 1 / (1 + 1j * lines), factor * lines, "rad", axis, 4)
        found = read_frequency_response(written({**entries, "orddenom_axis_units_lab": "N*m"}))
        np.testing.assert_allclose(found.frequencies, lines, rtol=2e-6)  # the format has six digits

    def test_a_response_over_revolutions(self, written):
        from torsionnet.io import read_frequency_response

        entries = self.function("theta / T", np.ones(9) + 0j, np.arange(1.0, 10.0), "rad", "rev", 4)
        with pytest.raises(ModelError, match="wrong-unit"):
            read_frequency_response(written({**entries, "orddenom_axis_units_lab": "N*m"}))

    @pytest.mark.parametrize(
        ("length", "force", "name", "torque_unit"),
        [(1000.0, 1.0, "mm (newton)", 1e-3), (39.3701, 0.224809, "inch (pound f)", 0.112985), (1.0, 1.0, "SI", 1.0)],
    )
    def test_units_of_the_file(self, written, length, force, name, torque_unit):
        """A torque without a unit of its own is in the units of dataset 164, N mm or in lbf (0.112985 N m)."""
        import pyuff

        from torsionnet.io import read_frequency_response

        units = pyuff.prepare_164(
            units_code=9, units_description=name, temp_mode=1, length=length, force=force, temp=1.0, temp_offset=273.15
        )
        lines = np.arange(1, 41) * 0.5
        entries = self.function("theta / T", 1 / (1 + 1j * lines), lines, "NONE", "Hz", 4)
        coded = {**entries, "ordinate_spec_data_type": 8, "orddenom_spec_data_type": 13}
        found = read_frequency_response(written(units, coded))
        np.testing.assert_allclose(found.values[:, 0, 0] * torque_unit, 1 / (1 + 1j * lines), rtol=1e-5)
        record = {**self.function("T", torque(TIMES), TIMES, "NONE"), "ordinate_spec_data_type": 13}
        values = read_recording(written(record), names={"T": "T"})["T"].values
        np.testing.assert_allclose(values, torque_unit * torque(TIMES), rtol=1e-5, atol=1e-9)


class TestHdf5:
    @pytest.fixture
    def written(self, tmp_path):
        h5py = pytest.importorskip("h5py")

        def write(**content):
            path = tmp_path / "run.h5"
            with h5py.File(path, "w") as file:
                for name, (values, attributes) in content.items():
                    file.create_dataset(name.replace("__", "/"), data=values).attrs.update(attributes)
            return path

        return write

    @pytest.mark.parametrize("kept", [lambda number: number, lambda number: np.array([number])])
    def test_packed_values(self, written, kept):
        """Whole numbers of 0.01 N m about 5 N m, the attributes as h5py and as netCDF write them; -32768 is missing."""
        packed = np.round((10 * np.sin(TIMES) - 5) / 0.01).astype("i2")
        packed[7] = -32768
        attributes = {"scale_factor": kept(0.01), "add_offset": kept(5.0), "_FillValue": kept(np.int16(-32768))}
        path = written(T=(packed, {"units": "N*m", **attributes}), time=(TIMES, {"units": "s"}))
        found = read_recording(path)["T"]
        assert np.flatnonzero(np.isnan(found.values)).tolist() == [7]
        assert np.nanmax(np.abs(found.values - 10 * np.sin(TIMES))) < 0.0051
        assert found.notes == (
            "multiplied by 0.01, then 5 added, as the file says",
            "values of -32768 are missing, as NaN",
        )

    def test_a_fill_value_of_zero_is_said(self, written):
        path = written(T=(np.arange(-5, 5), {"units": "N*m", "fs": RATE, "_FillValue": 0}))
        found = read_recording(path)["T"]
        assert np.flatnonzero(np.isnan(found.values)).tolist() == [5]
        assert found.notes == ("values of 0 are missing, as NaN",)

    def test_a_factor_that_is_not_one_number(self, written):
        path = written(T=(TIMES, {"unit": "N*m", "fs": RATE, "scale_factor": np.array([0.5, 2.0])}))
        assert re.search("/T.*unreadable-file", refusal(path))

    def test_a_gain_that_may_be_meant_either_way_is_said(self, written):
        attributes = {"unit": "N*m", "fs": RATE, "gain": 2.0, "scale": 1.0, "offset": 1.0, "bias": 0.0}
        path = written(T=(torque(TIMES), attributes))
        said = warning("not applied, as nothing says how: its attributes gain (2), offset (1)")
        assert read_recording(path)["T"].notes == (said,)

    def test_a_rate_other_than_that_of_the_file_is_taken_with_a_warning(self, written):
        path = written(T=(torque(TIMES), {"unit": "N*m"}), fs=(np.array(RATE), {}))
        found = read_recording(path, sampling_rate=500)
        assert found.sampling_rate == 500
        assert warning("the file has a sampling rate of 1000 Hz; the 500 Hz given were taken") in found.notes

    def test_groups_have_their_own_times(self, written):
        slow = 0.25 + np.arange(1500) / 500
        path = written(
            fast__time=(TIMES, {}), fast__T=(torque(TIMES), {"unit": "N*m"}),
            slow__time=(slow, {}), slow__w=(speed(slow), {"unit": "rad/s"}),
        )  # fmt: skip
        assert re.search(r"500 Hz.*\(slow\.w\); 1000 Hz.*\(fast\.T\).*unlike-results", refusal(path))
        assert read_recording(path, names=["slow.w"]).start == 0.25
        found = read_recording(path, sampling_rate=1000, resample=True).between(0.75, 2.75)
        is_on_one_clock(found, "fast.T", "slow.w", within=2e-3)

    def test_coarse_times_of_groups_take_the_rate_that_is_given(self, written):
        times = np.arange(4000) / 4000
        path = written(
            a__time=(np.round(times, 3), {}), a__T=(torque(times), {"unit": "N*m"}),
            b__time=(np.round(times + 0.25, 3), {}), b__w=(speed(times + 0.25), {"unit": "rad/s"}),
        )  # fmt: skip
        assert re.search(r"channels\.b\.time: error: 2999 .*unordered-rows", refusal(path))
        found = read_recording(path, sampling_rate=4000)
        assert (found.sampling_rate, found.start) == (4000, 0.25)
        is_on_one_clock(found, "a.T", "b.w")
        assert re.search(r"channels\.a\.time: .*contradicting-values", refusal(path, sampling_rate=4100))

    def test_datasets_with_a_rate_and_a_start(self, written):
        path = written(
            T=(torque(TIMES), {"unit": "N*m", "fs": RATE}),
            w=(speed(TIMES - 0.25), {"unit": "rad/s", "dt": 1 / RATE, "t0": -0.25}),
        )
        found = read_recording(path)
        assert (found.start, len(found)) == (0.0, 3750)
        is_on_one_clock(found)

    FILE = {"fs": RATE}, {"dt": 1 / RATE, "t0": -1.0}, {"sampling_rate": np.array([RATE])}

    @pytest.mark.parametrize("of_file", FILE)
    @pytest.mark.parametrize("own", [{}, {"t0": 0.25}, {"fs": RATE, "t0": 0.25}, {"dt": 1 / RATE, "start": 0.25}])
    def test_attributes_of_the_file_hold_where_a_dataset_has_none(self, written, of_file, own):
        import h5py

        begin = of_file.get("t0", 0.0)
        late = own.get("t0", own.get("start", begin))
        path = written(T=(torque(TIMES + begin), {"unit": "N*m"}), w=(speed(TIMES + late), {"unit": "rad/s", **own}))
        with h5py.File(path, "a") as file:
            file.attrs.update(of_file)
        found = read_recording(path)
        assert (found.sampling_rate, found.start) == (RATE, late)
        is_on_one_clock(found)

    def test_a_rate_of_a_dataset_beside_that_of_the_file(self, written):
        import h5py

        path = written(T=(torque(TIMES), {"unit": "N*m"}), w=(speed(TIMES * 2), {"unit": "rad/s", "fs": RATE / 2}))
        with h5py.File(path, "a") as file:
            file.attrs["fs"] = RATE
        assert re.search(r"500 Hz.*\(w\); 1000 Hz.*\(T\).*unlike-results", refusal(path))

    @pytest.mark.parametrize("texts", [
        ("2024-05-03T10:12:13", "2024-05-03T10:12:13.250"), ("2024-05-03 10:12:13.75Z", "2024-05-03 12:12:14+02:00"),
    ])  # fmt: skip
    def test_dates_at_which_datasets_begin(self, written, texts):
        first, second = ({"fs": RATE, "start_time": text} for text in texts)
        path = written(
            T=(torque(TIMES), {"unit": "N*m", **first}), w=(speed(TIMES + 0.25), {"unit": "rad/s", **second})
        )
        found = read_recording(path)
        assert (found.start, len(found)) == (0.25, 3750)
        is_on_one_clock(found)

    def test_times_of_a_group_say_more_than_its_rate(self, written):
        import h5py

        late = TIMES + 0.25
        path = written(
            a__time=(TIMES, {}), a__T=(torque(TIMES), {"unit": "N*m"}),
            b__time=(late, {}), b__w=(speed(late), {"unit": "rad/s"}),
        )  # fmt: skip
        with h5py.File(path, "a") as file:
            for name in "ab":
                file[name].attrs["fs"] = RATE
        found = read_recording(path)
        assert found.start == 0.25
        is_on_one_clock(found, "a.T", "b.w")

    def test_a_rate_that_the_times_contradict(self, written):
        path = written(T=(torque(TIMES), {"unit": "N*m"}), time=(TIMES, {}), fs=(np.array(500.0), {}))
        found = read_recording(path)
        assert found.sampling_rate == RATE
        said = warning("the file has a sampling rate of 500 Hz; that of its time stamps was taken, 1000 Hz")
        assert said in found.notes

    @pytest.mark.parametrize("numbers", [{"fs": RATE, "dt": 0.002}, {"sampling_rate": 500.0, "dt": 1 / RATE}])
    def test_a_rate_and_an_interval_that_contradict_each_other(self, written, numbers):
        assert re.search(r" \d+ Hz, .* 0.00\d s .*unreadable-file", refusal(written(T=(torque(TIMES), numbers))))

    @pytest.mark.parametrize(("unit", "text"), [("degrees", "over degrees"), ("seconds since 2024-05-03", "")])
    def test_dimension_scales(self, tmp_path, unit, text):
        h5py = pytest.importorskip("h5py")
        path = tmp_path / "run.nc.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("x", data=TIMES).attrs["units"] = unit
            file["x"].make_scale("x")
            file.create_dataset("T", data=torque(TIMES)).attrs["units"] = "N*m"
            file["T"].dims[0].attach_scale(file["x"])
        if text:
            for names in (None, ["T"]):
                assert re.search(rf"channels\.T: .* {text}.*wrong-file", refusal(path, names=names))
        else:
            assert read_recording(path, names=["T"]).sampling_rate == RATE


class TestMat:
    @pytest.mark.parametrize("rate", [1000.0, 25600.0])
    def test_times_in_days(self, tmp_path, rate):
        """A datenum of this century has steps of 10 us; as seconds 1 kHz would be 86.4 MHz."""
        from scipy.io import savemat

        times = np.arange(8000) / rate
        savemat(tmp_path / "r.mat", {"t": 739375.4251 + times / 86400, "T": torque(times)})
        found = read_recording(tmp_path / "r.mat", {"T": "torque"})
        assert found.sampling_rate == pytest.approx(rate, rel=1e-6)
        assert (found.start, found.times) == (0.0, None)
        assert any("counts from 2024-05-03 10:12:08.640 (datenum of Matlab)" in note for note in found.notes)
        assert [len(block) for block in iter_blocks(tmp_path / "r.mat", 4000 / rate, {"T": "torque"})] == [4000, 4000]

    @pytest.mark.parametrize("late", [0.25, 0.0])
    def test_times_of_each_channel_as_dewesoft_writes_them(self, tmp_path, late):
        from scipy.io import savemat

        content = {
            "Sample_rate": RATE, "Data1_T": torque(TIMES), "Data1_time_T": TIMES,
            "Data1_w": speed(TIMES + late), "Data1_time_w": TIMES + late,
        }  # fmt: skip
        savemat(tmp_path / "run.mat", content)
        found = read_recording(tmp_path / "run.mat")
        assert (found.names, found.start) == (("Data1_T", "Data1_w"), late)
        is_on_one_clock(found, "Data1_T", "Data1_w")

    def test_times_named_after_a_channel(self, tmp_path):
        from scipy.io import savemat

        late = TIMES + 0.25
        savemat(tmp_path / "r.mat", {"T": torque(TIMES), "t_T": TIMES, "t_w": late, "w": speed(late)})
        found = read_recording(tmp_path / "r.mat", {"T": "torque", "w": "velocity"})
        assert (found.names, found.start, len(found)) == (("T", "w"), 0.25, 3750)
        is_on_one_clock(found)

    def test_other_times_that_nothing_says_anything_of(self, tmp_path):
        from scipy.io import savemat

        content = {"t": TIMES, "T": torque(TIMES), "t2": TIMES + 0.25, "w": speed(TIMES)}
        savemat(tmp_path / "r.mat", content)
        told = warning("t2 holds other times than t, which was taken for all channels")
        assert told in read_recording(tmp_path / "r.mat").notes
        savemat(tmp_path / "r.mat", {**content, "t2": TIMES})
        assert told not in read_recording(tmp_path / "r.mat").notes

    @pytest.mark.parametrize("stamps", [lambda times: times, lambda times: 739375.5 + times / 86400])
    def test_structures_have_their_own_times(self, tmp_path, stamps):
        """Times in s, and in days of one calendar, of which the resolution is 10 us."""
        from scipy.io import savemat

        late = TIMES + 0.25
        content = {"a": {"time": stamps(TIMES), "T": torque(TIMES)}, "b": {"time": stamps(late), "w": speed(late)}}
        savemat(tmp_path / "r.mat", content)
        found = read_recording(tmp_path / "r.mat", {"a.T": "torque", "b.w": "velocity"})
        assert (found.start, len(found)) == (pytest.approx(0.25, abs=2e-5), 3750)
        is_on_one_clock(replace(found, start=0.25), "a.T", "b.w")


class TestTables:
    @pytest.fixture(params=["csv", "parquet"])
    def written(self, request, tmp_path):
        def write(**columns):
            """Write columns of unequal lengths side by side, as exports of several channels have them."""
            path, most = tmp_path / f"run.{request.param}", max(map(len, columns.values()))
            if request.param == "csv":
                rows = [[f"{v[row]:.12g}" if row < len(v) else "" for v in columns.values()] for row in range(most)]
                path.write_text("\n".join([";".join(columns), *map(";".join, rows)]) + "\n")
            else:
                parquet, arrow = (pytest.importorskip(name) for name in ("pyarrow.parquet", "pyarrow"))
                filled = {name: [*v, *[None] * (most - len(v))] for name, v in columns.items()}
                parquet.write_table(arrow.table(filled), path)
            return path

        return write

    @pytest.mark.parametrize(("first", "second"), [
        ("time", "time 2"), ("t_T", "t_w"), ("Zeit1 [s]", "Zeit2 [s]"),
        ("Zeit  1 - Standardmessrate [s]", "Zeit  2 - langsam [s]"),
    ])  # fmt: skip
    def test_columns_have_the_times_to_their_left(self, written, first, second):
        late = TIMES + 0.25
        path = written(**{first: TIMES, "T [Nm]": torque(TIMES), second: late, "w [rad/s]": speed(late)})
        found = read_recording(path)
        assert (found.names, found.start, len(found)) == (("T", "w"), 0.25, 3750)
        is_on_one_clock(found)

    def test_units_of_several_columns_of_times_may_be_given(self, written):
        late = TIMES + 0.25
        path = written(**{"t1": 1000 * TIMES, "T [Nm]": torque(TIMES), "t2": late / 60, "w [rad/s]": speed(late)})
        found = read_recording(path, units={"t1": "ms", "t2": "min", "w": "rad/s"})
        assert (found.sampling_rate, found.start) == (pytest.approx(RATE, rel=1e-9), pytest.approx(0.25, rel=1e-9))
        is_on_one_clock(found, within=1e-6)
        assert read_recording(path, names=["T"], units={"t1": "ms"}).sampling_rate == RATE
        refused = refusal(path, units={"t1": "deg", "t2": "min"}, names=["T", "w"])
        assert re.search(r"(T|channels\.T:) .* over deg.*wrong-file", refused)

    def test_times_without_a_unit_that_make_1_hz_are_doubted(self, written):
        path = written(**{"t1": 1000 * TIMES, "T [Nm]": torque(TIMES), "t2": 1000 * TIMES + 250, "w [rad/s]": TIMES})
        said = "has no unit and was taken for s: sampled at 1 Hz for 3999 s; if it is in ms, or counts ticks, give"
        assert [
            name for name in ("t1", "t2", "T") if any(f"{name} {said}" in note for note in read_recording(path).notes)
        ] == ["t1", "t2"]

    def test_columns_of_two_rates(self, written):
        slow = np.arange(2000) / 500
        path = written(**{"t": TIMES, "T [Nm]": torque(TIMES), "t2": slow, "w [rad/s]": speed(slow)})
        assert re.search(r"500 Hz.*\(w\); 1000 Hz.*\(T\).*unlike-results", refusal(path))
        assert len(read_recording(path, names=["w"])) == 2000
        is_on_one_clock(read_recording(path, sampling_rate=1000, resample=True).between(0.5, 3.5), within=2e-3)

    def test_columns_of_dates(self, tmp_path):
        parquet, arrow = (pytest.importorskip(name) for name in ("pyarrow.parquet", "pyarrow"))
        first = np.datetime64("2024-05-03T10:12:13.000", "ms") + np.arange(4000).astype("timedelta64[ms]")
        late = (first + np.timedelta64(250, "ms")).astype("datetime64[us]")
        columns = {"time": first, "T [Nm]": torque(TIMES), "time2": late, "w [rad/s]": speed(TIMES + 0.25)}
        parquet.write_table(arrow.table(columns), tmp_path / "run.parquet")
        found = read_recording(tmp_path / "run.parquet")
        assert (found.start, len(found)) == (0.25, 3750)
        is_on_one_clock(found)

    @pytest.mark.parametrize(
        "other", [{"operating time [h]": 900 + TIMES / 3600}, {"n1 [s]": 1.1 * TIMES}, {"time [ms]": 1000 * TIMES}]
    )
    def test_other_columns_of_times_are_no_clocks(self, written, other):
        path = written(**{"time [s]": TIMES, "T [Nm]": torque(TIMES), **other, "w [rad/s]": speed(TIMES)})
        found = read_recording(path)
        assert (found.start, len(found)) == (0.0, 4000)
        is_on_one_clock(found)
