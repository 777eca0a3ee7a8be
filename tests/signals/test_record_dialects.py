"""Records as recorders and their users write them: quoted numbers, units in other spellings, clocks without a unit."""

import numpy as np
import pytest

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import ModelError
from torsionnet.base.units import parse_unit
from torsionnet.signals.records.recording_files import iter_blocks, read_recording


def write(tmp_path, text, name="r.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


QUOTED = "".join(f'"0,{row:03d}","{row},5"\n' for row in range(30))


class TestQuotedNumbers:
    @pytest.mark.parametrize("heading", ["t,T [Nm]\n", '"t","T [Nm]"\n', '"t","T, left [Nm]"\n'])
    def test_decimal_commas_between_commas(self, tmp_path, heading):
        found = read_recording(write(tmp_path, heading + QUOTED))
        assert found.sampling_rate == 1000.0
        assert found.signals[0].values.tolist() == [row + 0.5 for row in range(30)]
        assert "assumed: cells between commas, decimal comma" in found.notes

    def test_whole_numbers_without_quotes_between_them(self, tmp_path):
        rows = "".join(f'{row},"{row},5"\n' for row in range(30))
        assert read_recording(write(tmp_path, "t [ms],T [Nm]\n" + rows))["T"].values[7] == 7.5

    def test_without_a_heading_nothing_is_split(self, tmp_path):
        found = read_recording(write(tmp_path, QUOTED), sampling_rate=10.0)
        assert found.names == ("column_1", "column_2")
        assert found["column_2"].values[1] == 1.5

    @pytest.mark.parametrize(
        ("row", "message"),
        [
            ('"0,030","x,5"\n', r":32:10: .*not-a-number"),
            ("0,030,30,5\n", r":32:1: .*wrong-count"),
            ('"0,030","1.234,5"\n', r":32:10: .*1\.234.*not-a-number"),
        ],
    )
    def test_other_rows_are_refused(self, tmp_path, row, message):
        with pytest.raises(ModelError, match=message):
            read_recording(write(tmp_path, "t,T [Nm]\n" + QUOTED + row))

    def test_quotes_that_begin_late(self, tmp_path):
        """Beyond the lines that are looked at first."""
        rows = "".join(f"{row},{row}\n" for row in range(500))
        with pytest.raises(ModelError, match=r":502:6: .*not-a-number"):
            read_recording(write(tmp_path, "t [ms],T [Nm]\n" + rows + '500,"1,5"\n'))

    def test_both_as_commas_without_quotes(self, tmp_path):
        path = write(tmp_path, "t,T [Nm]\n0,1,2,5\n0,2,2,6\n")
        with pytest.raises(ModelError, match="unreadable-file"):
            read_recording(path, separator=",", decimal=",")


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("N-m", "N*m"), ("N.m", "N*m"), ("kN-m", "kN*m"), ("kN.m", "kN*m"), ("ft-lb", "lbf*ft"), ("lb-ft", "lbf*ft"),
        ("ft.lbf", "lbf*ft"), ("FT-LBS", "lbf*ft"), ("in-lb", "lbf*in"), ("lbf-in", "lbf*in"), ("RPM", "rpm"),
        ("Rpm", "rpm"), ("rad.s-1", "rad/s"), ("rad/sec", "rad/s"), ("rad/s2", "rad/s^2"), ("min-1", "rpm"),
    ],
)  # fmt: skip
def test_units_in_other_spellings(tmp_path, written, meant):
    assert parse_unit(plain_unit(written)).factor == parse_unit(meant).factor
    for heading in (f"T [{written}]", f"T ({written})", f"T / {written}"):
        (signal,) = read_recording(write(tmp_path, f"t [s],{heading}\n0,1\n0.1,2\n"))
        assert (signal.name, signal.values[0]) == ("T", float(parse_unit(meant).factor))


@pytest.mark.parametrize("unit", ["m/s", "lb", "lb-s", "N-", "kg-m2"])
def test_other_units_tell_no_quantity(tmp_path, unit):
    (signal,) = read_recording(write(tmp_path, f"t [s],x [{unit}]\n0,1\n0.1,2\n"))
    assert signal.quantity == ""


def clocked(tmp_path, step, count=100, name="t", unit=""):
    heading = f"{name} [{unit}]" if unit else name
    rows = "".join(f"{step * row:.10g},{np.sin(row):.6f}\n" for row in range(count))
    return write(tmp_path, f"{heading},T [Nm]\n{rows}")


class TestClockWithoutUnit:
    @pytest.mark.few(1)
    @pytest.mark.parametrize(("step", "count"), [(1.0, 100), (0.1, 100), (1000.0, 100), (0.02, 200_000)])
    def test_ms_are_doubted(self, tmp_path, step, count):
        found = read_recording(clocked(tmp_path, step, count))
        told = [note for note in map(str, found.notes) if note.startswith("warning: t has no unit and was taken for s")]
        assert len(told) == 1
        assert told[0].endswith("give its unit")

    @pytest.mark.parametrize("step", [1e-3, 0.02])
    def test_s_are_not(self, tmp_path, step):
        assert not any("warning" in note for note in read_recording(clocked(tmp_path, step)).notes)
        assert not any("warning" in note for note in read_recording(clocked(tmp_path, 1.0, unit="s")).notes)

    def test_its_unit_may_be_given(self, tmp_path):
        found = read_recording(clocked(tmp_path, 1.0), units={"t": "ms"})
        assert found.sampling_rate == 1000.0
        assert not any("warning" in note for note in found.notes)
        other = read_recording(clocked(tmp_path, 1.0, name="Abscissa"), units={"Abscissa": "msec"})
        assert (other.names, other.sampling_rate) == (("T",), 1000.0)
        with pytest.raises(ModelError, match="wrong-unit"):
            read_recording(clocked(tmp_path, 1.0), units={"t": "Nm"})

    def test_in_blocks(self, tmp_path):
        blocks = list(iter_blocks(clocked(tmp_path, 1.0), 0.05, units={"t": "ms"}))
        assert [len(block) for block in blocks] == [50, 50]


class TestTdms:
    def waves(self, tmp_path, offsets, increments=(1e-3, 1e-3)):
        nptdms = pytest.importorskip("nptdms")
        path = tmp_path / "r.tdms"
        with nptdms.TdmsWriter(str(path)) as writer:
            writer.write_segment([
                nptdms.ChannelObject(
                    "g", name, np.arange(9.0),
                    {"wf_increment": increments[number], "wf_start_offset": offsets[number], "unit_string": "N-m"},
                )
                for number, name in enumerate(("a", "b"))
            ])  # fmt: skip
        return read_recording(path)

    def test_offset_is_honoured_and_told(self, tmp_path):
        found = self.waves(tmp_path, (2.0, 2.0))
        assert found.start == 2.0
        assert "begins at 2 s, its wf_start_offset" in found.notes
        assert not any("warning" in note for note in found.notes)

    def test_offsets_that_differ_and_several_rates_are_refused(self, tmp_path):
        with pytest.raises(ModelError, match=r"(?s)1000.*1000.*unlike-results"):
            self.waves(tmp_path, (0.0, 0.5))
        with pytest.raises(ModelError, match=r"(?s)500.*0\.5.*unlike-results"):
            self.waves(tmp_path, (0.0, 0.5), (1e-3, 2e-3))


VOLTS = np.round(np.random.default_rng(0).normal(size=(50, 2)), 5)


def scope(heading, row):
    return heading + "".join(row(at, *pair) for at, pair in enumerate(VOLTS))


SCOPES = {
    "PicoScope": (scope("Time,Channel A,Channel B\n(ms),(V),(mV)\n\n", lambda at, a, b: f"{at * 0.04 - 1:.8f},{a},{b}\n"),
                  ("Channel A", "Channel B"), 25e3, -0.001),
    "PicoScope in German": (scope("Zeit;Kanal A;Kanal B\n(ms);(V);(V)\n\n",
                                  lambda at, a, b: f"{at * 0.04 - 1:.8f};{a};{b}\n".replace(".", ",")),
                            ("Kanal A", "Kanal B"), 25e3, -0.001),
    "PicoScope saved again by a spreadsheet": (scope("Time,Channel A,Channel B\n(ms),(V),(mV)\n,,\n", lambda at, a, b: f"{at * 0.04 - 1:.8f},{a},{b}\n"),
                                               ("Channel A", "Channel B"), 25e3, -0.001),
    "PicoScope in whole microseconds": (scope("Time,Channel A,Channel B\n(µs),(V),(V)\n\n", lambda at, a, b: f"{at * 40},{a},{b}\n"),
                                        ("Channel A", "Channel B"), 25e3, 0.0),
    "Keysight": (scope("x-axis,1,2\nsecond,Volt,Volt\n", lambda at, a, b: f"{at * 4e-5 - 84.48e-6:.5E},{a:+.5E},{b:+.5E}\n"),
                 ("1", "2"), 25e3, -84.48e-6),
    "Rigol DS1000Z": (scope("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-5.88E-02,1.00E-04,\n",
                            lambda at, a, b: f"{at},{a},{b},\n"), ("CH1", "CH2"), 1e4, -0.0588),
    "Rigol DS1000E": (scope("Time,X(CH1),X(CH2),\nSecond,Volt,Volt,\n", lambda at, a, b: f"{at * 1e-4:.6e},{a},{b},\n"),
                      ("X(CH1)", "X(CH2)"), 1e4, 0.0),
    "Rigol MSO5000": (scope("CH1(V),CH2(V),t0 = -25s, tInc = 2e-06s,\n", lambda _, a, b: f"{a},{b},,\n"),
                      ("CH1", "CH2"), 5e5, -25.0),
}  # fmt: skip


class TestOscilloscopes:
    @pytest.mark.parametrize("case", SCOPES)
    def test_names_units_and_clock_are_read(self, tmp_path, case):
        text, names, rate, start = SCOPES[case]
        found = read_recording(write(tmp_path, text))
        assert (found.names, found.times) == (names, None)
        assert (found.sampling_rate, found.start) == (
            pytest.approx(rate, rel=1e-12),
            pytest.approx(start, rel=1e-6, abs=1e-12),
        )
        np.testing.assert_array_equal([signal.values for signal in found], VOLTS.T)
        assert all("in V" in signal.notes[0] or "in mV" in signal.notes[0] for signal in found)

    def test_a_single_channel_below_whole_numbers_is_no_decimal_comma(self, tmp_path):
        text = "Time,Channel A\n(ms),(N·m)\n\n" + "".join(f"{at},{at % 7}\n" for at in range(50))
        found = read_recording(write(tmp_path, text))
        assert (found.sampling_rate, found["Channel A"].quantity, found["Channel A"].values[8]) == (
            1000.0,
            "torque",
            1.0,
        )

    def test_a_value_beyond_the_range_is_infinite(self, tmp_path):
        text = "Time,Channel A\n(ms),(V)\n\n" + "".join(f"{at},{'-∞' if at == 7 else 1.5}\n" for at in range(50))
        assert read_recording(write(tmp_path, text))["Channel A"].values[6:9].tolist() == [1.5, -np.inf, 1.5]

    def test_an_interval_of_zero_is_refused(self, tmp_path):
        with pytest.raises(ModelError, match="unreadable-file"):
            read_recording(write(tmp_path, SCOPES["Rigol DS1000Z"][0].replace("1.00E-04", "0")))

    def test_a_fault_has_its_place_below_a_blank_line(self, tmp_path):
        text = SCOPES["PicoScope"][0].replace(f"{VOLTS[3, 1]}\n", "x\n")
        with pytest.raises(ModelError, match=r":7:19: .*not-a-number"):
            read_recording(write(tmp_path, text))


class TestNumbersThatTellTheClock:
    """Arrays with a rate, an interval or a start beside them, written by scipy and numpy."""

    @pytest.mark.parametrize(("numbers", "rate", "start"), [
        ({"Tstart": -0.01, "Tinterval": 4e-5, "Length": 50.0, "Version": "6.14"}, 25e3, -0.01), ({"dt": 0.001}, 1000.0, 0.0),
        ({"fs": 2048.0, "t0": 3.0}, 2048.0, 3.0), ({"Fs": 1e4, "dt": 1e-4}, 1e4, 0.0), ({"sample_interval": 0.5}, 2.0, 0.0),
    ])  # fmt: skip
    @pytest.mark.parametrize("ending", [".mat", ".npz"])
    def test_by_their_names(self, tmp_path, numbers, rate, start, ending):
        from scipy.io import savemat

        content, path = (
            {"A": np.float32(VOLTS[:, :1]), "B": np.float32(VOLTS[:, 1:]), **numbers},
            tmp_path / f"r{ending}",
        )
        savemat(path, content) if ending == ".mat" else np.savez(path, **content)
        found = read_recording(path)
        assert (found.names, found.sampling_rate, found.start) == (("A", "B"), pytest.approx(rate, rel=1e-14), start)
        np.testing.assert_array_equal(found["B"].values, np.float32(VOLTS[:, 1]))

    def test_of_each_structure_its_own(self, tmp_path):
        from scipy.io import savemat

        savemat(tmp_path / "r.mat", {"a": {"T": VOLTS[:, 0], "dt": 0.001}, "b": {"w": VOLTS[:, 1], "fs": 500.0}})
        for name, rate in (("a.T", 1000.0), ("b.w", 500.0)):
            assert (
                read_recording(tmp_path / "r.mat", names={name: "x"}, quantities={name: "torque"}).sampling_rate == rate
            )
        with pytest.raises(ModelError, match="500 Hz"):
            read_recording(tmp_path / "r.mat")

    @pytest.mark.parametrize(("numbers", "message"), [
        ({"dt": 0.0}, "implausible-size"), ({"fs": -1.0}, "implausible-size"),
        ({"fs": 999.0, "dt": 0.001}, r"(?s)999.*0\.001.*unreadable-file"),
    ])  # fmt: skip
    def test_that_contradict_are_refused(self, tmp_path, numbers, message):
        from scipy.io import savemat

        savemat(tmp_path / "r.mat", {"T": VOLTS[:, 0], **numbers})
        with pytest.raises(ModelError, match=message):
            read_recording(tmp_path / "r.mat")


class TestTimeStampsOfTdms:
    BEGIN = np.datetime64("2024-05-03T10:12:13.000001")

    def write(self, path, *groups):
        """Groups of time stamps and values, through npTDMS."""
        from nptdms import ChannelObject, TdmsWriter

        with TdmsWriter(path) as file:
            for name, microseconds, channel, values in groups:
                stamps = self.BEGIN + microseconds.astype("timedelta64[us]")
                unit = {"unit_string": "Nm"}
                file.write_segment([ChannelObject(name, "Time", stamps), ChannelObject(name, channel, values, unit)])

    def test_are_the_clock_of_their_group(self, tmp_path):
        self.write(tmp_path / "r.tdms", ("g", np.arange(50) * 500, "T", VOLTS[:, 0]))
        found = read_recording(tmp_path / "r.tdms")
        assert (found.names, found.sampling_rate, found.start, found.times) == (("T",), 2000.0, 0.0, None)
        np.testing.assert_array_equal(found["T"].values, VOLTS[:, 0])
        assert "Time counts from 2024-05-03T10:12:13.000001 UTC" in found.notes

    def test_uneven_ones_are_kept(self, tmp_path):
        steps = np.cumsum(np.random.default_rng(1).integers(500, 1500, 50))
        self.write(tmp_path / "r.tdms", ("g", steps, "T", VOLTS[:, 0]))
        assert read_recording(tmp_path / "r.tdms").times == pytest.approx((steps - steps[0]) * 1e-6, abs=1e-12)

    def test_of_two_groups_are_two_clocks(self, tmp_path):
        groups = ("g", np.arange(50) * 500, "T", VOLTS[:, 0]), ("h", np.arange(25) * 1000, "w", VOLTS[:25, 0])
        self.write(tmp_path / "r.tdms", *groups)
        for name, rate in (("g/T", 2000.0), ("h/w", 1000.0)):
            assert read_recording(tmp_path / "r.tdms", names=[name]).sampling_rate == rate
        with pytest.raises(ModelError, match="sampled at 2 rates"):
            read_recording(tmp_path / "r.tdms")

    def is_later_by_5_samples(self, path):
        found = read_recording(path)
        assert (set(found.names), found.sampling_rate, found.start) == ({"g/T", "h/w"}, 2000.0, pytest.approx(0.0025))
        np.testing.assert_array_equal(found["g/T"].values, VOLTS[5:, 0])
        np.testing.assert_array_equal(found["h/w"].values, VOLTS[:45, 1])

    def test_of_a_group_that_begins_later(self, tmp_path):
        groups = ("g", np.arange(50) * 500, "T", VOLTS[:, 0]), ("h", np.arange(50) * 500 + 2500, "w", VOLTS[:, 1])
        for order in (groups, groups[::-1]):
            self.write(tmp_path / "r.tdms", *order)
            self.is_later_by_5_samples(tmp_path / "r.tdms")

    @pytest.mark.parametrize("first", ["stamps", "waveform"])
    def test_beside_a_waveform_that_begins_at_another_time(self, tmp_path, first):
        from nptdms import ChannelObject, TdmsWriter

        stamped, even = (("g", "T", 0), ("h", "w", 1)) if first == "stamps" else (("h", "w", 1), ("g", "T", 0))
        stamps, begun = (self.BEGIN + np.timedelta64(late, "us") for late in (2500 * stamped[2], 2500 * even[2]))
        with TdmsWriter(tmp_path / "r.tdms") as file:
            file.write_segment([
                ChannelObject(stamped[0], "Time", stamps + (np.arange(50) * 500).astype("m8[us]")),
                ChannelObject(*stamped[:2], VOLTS[:, stamped[2]]),
                ChannelObject(*even[:2], VOLTS[:, even[2]], {"wf_increment": 0.0005, "wf_start_time": begun}),
            ])  # fmt: skip
        self.is_later_by_5_samples(tmp_path / "r.tdms")

    @pytest.mark.parametrize(("unit", "scale"), [("s", 1.0), ("ms", 1000.0), ("", 1.0)])
    def test_numbers_are_the_clock_of_their_group_too(self, tmp_path, unit, scale):
        from nptdms import ChannelObject, TdmsWriter

        with TdmsWriter(tmp_path / "r.tdms") as file:
            for at, (name, channel, kind) in enumerate((("g", "T", "Nm"), ("h", "w", "rad/s"))):
                times = (np.arange(50) + 5 * at) * 0.0005 * scale
                file.write_segment([
                    ChannelObject(name, "Time", times, {"unit_string": unit}),
                    ChannelObject(name, channel, VOLTS[:, at], {"unit_string": kind}),
                ])  # fmt: skip
        self.is_later_by_5_samples(tmp_path / "r.tdms")


class TestWhatIsNoColumnOfNumbers:
    def hdf5(self, path):
        import h5py

        with h5py.File(path, "w") as file:
            file.attrs["fs"] = 1000.0
            file["w"], file["T"] = VOLTS[:, 1], VOLTS[:, 0].reshape(-1, 1, 1)
            file["table"] = np.zeros(5, dtype=[("t", "f8"), ("T", "f8")])
            file["comment"] = "a text"

    def npz(self, path):
        table = np.zeros(5, dtype=[("t", "f8"), ("T", "f8")])
        np.savez(path, fs=1000.0, w=VOLTS[:, 1], T=VOLTS[:, 0].reshape(-1, 1, 1), table=table)

    def parquet(self, path):
        import pyarrow as pa
        from pyarrow import parquet

        columns = {"time": np.arange(50) / 1000, "w": VOLTS[:, 1], "T": list(VOLTS), "table": ["a text"] * 50}
        parquet.write_table(pa.table({name: pa.array(values) for name, values in columns.items()}), path)

    @pytest.mark.parametrize(("write", "ending"), [("hdf5", ".h5"), ("npz", ".npz"), ("parquet", ".parquet")])
    def test_is_named(self, tmp_path, write, ending):
        path = tmp_path / f"r{ending}"
        getattr(self, write)(path)
        found = read_recording(path)
        assert (found.names, found.sampling_rate) == (("w",), 1000.0)
        (said,) = [note for note in found.notes if "left out" in note]
        assert said in {f"left out, as no column of numbers: {names}" for names in ("T, table", "table, T")}
        with pytest.raises(ModelError) as caught:
            read_recording(path, names=["T"])
        assert " w [unknown-channel]\n" in str(caught.value)
        assert f"note: {said}\n1 error in" in str(caught.value)

    def test_in_mat_files(self, tmp_path):
        from scipy.io import savemat

        content = {"fs": 1000.0, "w": VOLTS[:, 1], "T": VOLTS[:, 0].reshape(-1, 1, 1), "z": VOLTS[:9, 0] + 1j}
        savemat(tmp_path / "r.mat", {**content, "empty": np.zeros((0, 0)), "cells": np.array(["a", "b"], dtype=object)})
        notes = read_recording(tmp_path / "r.mat").notes
        assert [note for note in notes if "left out" in note] == [
            "T was left out: 50 by 1 by 1 numbers are no channels", "z was left out: complex numbers are no channels",
            "left out, as no column of numbers: cells",
        ]  # fmt: skip

    def test_no_rate_is_asked_for_where_there_is_nothing(self, tmp_path):
        np.savez(tmp_path / "r.npz", table=np.zeros(5, dtype=[("t", "f8"), ("T", "f8")]))
        with pytest.raises(ModelError, match=r"wrong-file\]\nnote: .* table\n1 err"):
            read_recording(tmp_path / "r.npz")


def test_decimals_of_parquet(tmp_path):
    from decimal import Decimal

    import pyarrow as pa
    from pyarrow import parquet

    cells = [Decimal(str(value)) if value > -1 else None for value in VOLTS[:, 0]]
    columns = {"time": [Decimal(at) / 1000 for at in range(50)], "T [Nm]": cells}
    table = pa.table({name: pa.array(column, pa.decimal128(12, 5)) for name, column in columns.items()})
    parquet.write_table(table, tmp_path / "r.parquet")
    found = read_recording(tmp_path / "r.parquet")
    assert (found.names, found.sampling_rate) == (("T",), 1000.0)
    np.testing.assert_array_equal(found["T"].values, [np.nan if cell is None else float(cell) for cell in cells])
