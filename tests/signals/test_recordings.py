"""Recordings from and into files, and what is said of faulty ones."""

import re
import tracemalloc
import zipfile

import numpy as np
import pytest
from fuzz.kinds import KINDS
from hypothesis import assume, given
from hypothesis import strategies as st
from support.faults import placed_faults
from support.foreign_files import CHILD_ENDINGS

from torsionnet.base.errors import MissingExtraError, ModelError, TorsionnetWarning, UsageError
from torsionnet.signals.encoder import angle_from_counts, angle_from_pulses, unwrapped
from torsionnet.signals.formats import extras, npz
from torsionnet.signals.formats.registry import FORMATS
from torsionnet.signals.pulses import missing_pulses
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.recording_checks import check_recording
from torsionnet.signals.records.recording_files import iter_blocks, read_recording, write_recording
from torsionnet.signals.resampling import resampled
from torsionnet.signals.value_faults import encoder_leaps, wrap_jumps

EXTRAS = {".tdms": "nptdms", ".uff": "pyuff", ".h5": "h5py", ".parquet": "pyarrow", ".mf4": "asammdf"}
ENDINGS = [".csv", ".npz", ".mat", *EXTRAS]


LABELS = {ending: form.label for form in FORMATS if form.open_source for ending in form.endings}


def test_every_format_is_tested():
    """Here, in tests/signals/test_foreign_files.py if a library reads it in a process of its own, and by fuzzing."""
    written = {form.label for form in FORMATS if form.write}
    assert {LABELS[ending] for ending in ENDINGS} == written, "add an ending to ENDINGS in this file"
    own = {"text", "NPZ", "MDF", "WAV"}  # asammdf takes a second to be imported in each process
    assert {LABELS[ending] for ending in CHILD_ENDINGS} == set(LABELS.values()) - own, (
        "add it to CHILD_ENDINGS, or to `own` here if no library reads it"
    )
    fuzzed = {LABELS[f".{name.removeprefix('record.')}"] for name in KINDS if name.startswith("record.")}
    assert fuzzed | {"MDF"} == set(LABELS.values()), "add it to tests/fuzz/kinds.py"


RATE = 1000.0
TIME = np.arange(5000) / RATE


def recording(*, stamped=False):
    random = np.random.default_rng(1)
    values = random.normal(size=(3, 1001))
    times = np.cumsum(random.uniform(0.5, 1.5, 1001)) * 1e-3 if stamped else None
    signals = (
        Signal("T_T [1]", "torque", values[0], ("strain gauges",)),
        Signal("φ 1", "angle", values[1]),
        Signal("aux", "", values[2]),
    )
    rate, start = (1000 / (times[-1] - times[0]), times[0]) if stamped else (3333.3, 0.5)
    return Recording(signals, rate, start, times, "run 7", ("bench 2", "warm"))


def needs(ending):
    if ending in EXTRAS:
        pytest.importorskip(EXTRAS[ending])


def write(tmp_path, text, name="r.csv", encoding="utf-8"):
    path = tmp_path / name
    path.write_bytes(text.encode(encoding))
    return path


class TestRoundTrip:
    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat"])
    def test_equal_recordings_give_equal_bytes_on_any_day(self, tmp_path, ending, monkeypatch):
        write_recording(recording(), tmp_path / f"a{ending}")
        monkeypatch.setattr("time.asctime", lambda *_: "Thu Jan  1 00:00:00 2099")
        write_recording(recording(), tmp_path / f"b{ending}")
        assert (tmp_path / f"a{ending}").read_bytes() == (tmp_path / f"b{ending}").read_bytes()

    @pytest.mark.few(2)
    @pytest.mark.parametrize("stamped", [False, True])
    @pytest.mark.parametrize("ending", ENDINGS)
    def test_keeps_everything(self, tmp_path, ending, stamped):
        needs(ending)
        given, path = recording(stamped=stamped), tmp_path / f"r{ending}"
        write_recording(given, path)
        found = read_recording(path)
        assert found.names == given.names
        assert [signal.quantity for signal in found] == ["torque", "angle", ""]
        for ours, theirs in zip(found, given, strict=True):
            np.testing.assert_array_equal(ours.values, theirs.values)
        assert found.sampling_rate == pytest.approx(given.sampling_rate, rel=1e-15)
        np.testing.assert_array_equal(found.time, given.time)
        assert (found.times is not None) == stamped
        assert found.title == "run 7"
        if ending != ".uff":  # lines of 80 characters
            assert found.notes == given.notes
            assert found["T_T [1]"].notes == ("strain gauges",)
        assert [file.name for file in tmp_path.iterdir()] == [path.name]

    @pytest.mark.parametrize("ending", ENDINGS)
    def test_blocks_are_the_whole(self, tmp_path, ending):
        needs(ending)
        given, path = recording(), tmp_path / f"r{ending}"
        write_recording(given, path)
        blocks = list(iter_blocks(path, 0.1, names=["φ 1"]))
        assert [len(block) for block in blocks] == [333, 333, 333, 2]
        np.testing.assert_array_equal(np.concatenate([block["φ 1"].values for block in blocks]), given["φ 1"].values)
        assert [block.start for block in blocks] == pytest.approx([0.5 + i * 333 / 3333.3 for i in range(4)], rel=1e-12)

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".h5", ".tdms"])
    def test_values_may_be_a_memmap(self, tmp_path, ending):
        needs(ending)
        values = np.memmap(tmp_path / "values", dtype=float, mode="w+", shape=(100,))
        values[:] = np.arange(100)
        path = tmp_path / f"r{ending}"
        write_recording(Recording((Signal("T", "torque", values),), 10.0), path)
        np.testing.assert_array_equal(read_recording(path)["T"].values, np.arange(100))

    @pytest.mark.parametrize("ending", ENDINGS)
    def test_failure_leaves_the_old_file(self, tmp_path, monkeypatch, ending):
        needs(ending)

        def full(_target):
            raise OSError("no space left")

        path = tmp_path / f"r{ending}"
        path.write_text("old")
        monkeypatch.setattr("torsionnet.base.atomic._permissions", full)
        with pytest.raises(OSError, match="no space left"):
            write_recording(recording(), path)
        assert path.read_text() == "old"
        assert [file.name for file in tmp_path.iterdir()] == [path.name]

    @pytest.mark.parametrize("ending", [ending for ending in ENDINGS if ending != ".uff"])  # there names are no keys
    def test_two_channels_of_one_name_are_refused(self, tmp_path, ending):
        needs(ending)
        twice = Signal("T", "torque", np.zeros(3))
        with pytest.raises(UsageError, match="repeated-name"):
            write_recording(Recording((twice, twice), 1.0), tmp_path / f"r{ending}")
        assert list(tmp_path.iterdir()) == []

    def test_names_that_mat_files_cannot_take(self, tmp_path):
        for length in (63, 64):
            given = Recording((Signal("T" * length, "torque", np.arange(3.0)),), 10.0)
            if length == 63:
                write_recording(given, tmp_path / "r.mat")
                assert read_recording(tmp_path / "r.mat").names == given.names
            else:
                with pytest.raises(UsageError, match=r"(?s)63.*too-large"):
                    write_recording(given, tmp_path / "r.mat")


class TestForeignFiles:
    @pytest.mark.parametrize("rate", [1000.0, 1000.0003, 999.99, 31.25, 1 / 3])
    def test_rate_of_stamps_without_their_rounding(self, tmp_path, rate):
        """Nine digits of time say the rate to eight; one that is round is meant to be round."""
        lines = [f"{5 + place / rate:.9g},{place}" for place in range(2000)]
        found = read_recording(write(tmp_path, "\n".join(["time [s],T [Nm]", *lines])))
        assert found.sampling_rate == pytest.approx(rate, rel=1e-8)
        if rate in (1000.0, 31.25):
            assert found.sampling_rate == rate

    @pytest.mark.parametrize(
        ("name", "dialect", "message"),
        [
            ("r.npz", {"separator": ";"}, "needless-entry"),
            ("r.csv", {"delimiter": ";"}, "needless-entry"),
            ("r.csv", {"separator": ";", "quote": "'"}, "needless-entry"),
        ],
    )
    def test_what_cannot_be_said_of_a_file(self, tmp_path, name, dialect, message):
        (tmp_path / name).write_text("time;T\n0;1\n1;2\n")
        with pytest.raises(UsageError, match=message):
            read_recording(tmp_path / name, **dialect)

    def test_separator_and_decimal_may_be_given(self, tmp_path):
        path = write(tmp_path, "time;T [Nm]\n0;1,5\n1;2,5\n")
        assert read_recording(path, separator=";", decimal=",")["T"].values.tolist() == [1.5, 2.5]

    def test_units_become_si(self, tmp_path):
        path = write(tmp_path, "t [ms];M [kNm];phi [deg];n [rpm]\n0;1,5;180;60\n1;2;90;30\n")
        found = read_recording(path)
        assert [signal.quantity for signal in found] == ["torque", "angle", "velocity"]
        assert found["M"].values.tolist() == [1500.0, 2000.0]
        assert found["phi"].values == pytest.approx([np.pi, np.pi / 2])
        assert found["n"].values == pytest.approx([2 * np.pi, np.pi])
        assert found.sampling_rate == 1000.0
        assert "assumed: cells between semicolons, decimal comma" in found.notes
        assert found["M"].notes == ("converted from kNm",)

    @pytest.mark.parametrize(("unit", "step"), [("s", 0.01), ("ms", 10.0)])
    def test_blocks_last_as_long_as_asked(self, tmp_path, unit, step):
        lines = [f"{step * place:.6g},{place}" for place in range(1000)]
        path = write(tmp_path, "\n".join([f"time [{unit}],T [Nm]", *lines]))
        blocks = list(iter_blocks(path, seconds=3.0))
        assert [len(block) for block in blocks] == [300, 300, 300, 100]
        assert [block.start for block in blocks] == pytest.approx([0, 3, 6, 9])
        assert {round(block.sampling_rate, 9) for block in blocks} == {100.0}

    @pytest.mark.parametrize(
        ("text", "names", "note"),
        [
            ("time,T\ns,Nm\n0,1\n1,2\n", ("T",), "names and units from two rows of headings"),
            ("0 1\n1 2\n2 3\n", ("column_1", "column_2"), "no heading"),
            ("Device 7\nrun;3\n\ntime;T [Nm]\n0;1\n1;2\n", ("T",), "3 lines above the heading passed over"),
            ("time;T [Nm];\n0;1;\n1;2;\n", ("T",), "assumed: cells between semicolons, decimal point"),
            (
                "time T\n0.0D+00 1.0D+00\n1.0D+00 2.0D+00\n",
                ("T",),
                "assumed: cells between white spaces, decimal point",
            ),
            ('"time","T [Nm]"\n"0","1"\n"1","2"\n', ("T",), "assumed: cells between commas"),
        ],
    )
    def test_form_of_text_is_found_out_and_told(self, tmp_path, text, names, note):
        found = read_recording(write(tmp_path, text), sampling_rate=1.0)
        assert found.names == names
        assert any(note in said for said in found.notes)

    def test_empty_cells_are_counted_in_the_channels_read(self, tmp_path):
        text = "time;T [Nm];\n0;1;\n1;;\n2;3;\n"
        found = read_recording(write(tmp_path, text))
        assert "1 empty cells are NaN" in found.notes
        np.testing.assert_array_equal(found["T"].values, [1.0, np.nan, 3.0])

    @pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16"])
    def test_encodings(self, tmp_path, encoding):
        found = read_recording(write(tmp_path, "time;φ [°]\n0;1\n1;2\n".replace("φ", "Ü"), encoding=encoding))
        assert found["Ü"].values == pytest.approx(np.radians([1, 2]))

    def test_mat_variables_and_fields(self, tmp_path):
        from scipy.io import savemat

        savemat(
            tmp_path / "r.mat", {"fs": 50.0, "T": np.arange(4.0), "run": {"phi": np.ones(4)}, "ab": np.ones((4, 2))}
        )
        found = read_recording(tmp_path / "r.mat", {"T": "torque"})
        assert found.sampling_rate == 50.0
        assert found.names == ("T", "run.phi", "ab_1", "ab_2")
        assert found["T"].quantity == "torque"

    def test_mat_v73(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "r.mat", "w", userblock_size=512) as file:
            for name, values in {"T": np.arange(5.0), "fs": np.array([20.0])}.items():
                file.create_dataset(name, data=values.reshape(1, -1)).attrs["MATLAB_class"] = np.bytes_("double")
        found = read_recording(tmp_path / "r.mat", {"T": "torque"})
        assert found["T"].values.tolist() == [0, 1, 2, 3, 4]
        assert found.sampling_rate == 20.0

    def test_tdms_waveform(self, tmp_path):
        nptdms = pytest.importorskip("nptdms")
        wave = {"wf_increment": 0.01, "wf_start_offset": 2.0, "unit_string": "kNm"}
        with nptdms.TdmsWriter(str(tmp_path / "r.tdms")) as writer:
            filled, empty = np.array([1, 2], dtype="i2"), np.zeros(0)
            writer.write_segment([nptdms.ChannelObject("g", *one, wave) for one in (("M", filled), ("n", empty))])
        found = read_recording(tmp_path / "r.tdms")
        assert found.names == ("M",)
        assert found["M"].values.tolist() == [1000.0, 2000.0]
        assert (found.sampling_rate, found.start) == (100.0, 2.0)

    def test_names_choose_and_rename(self, tmp_path):
        path = write(tmp_path, "time,a [Nm],b [V]\n0,1,2\n1,3,4\n")
        found = read_recording(path, names={"b": "T_T"}, quantities={"b": "torque"}, units={"b": "kNm"})
        assert found["T_T"].values.tolist() == [2000.0, 4000.0]

    def test_missing_extra_names_the_command(self, tmp_path, monkeypatch):
        monkeypatch.setitem(extras.EXTRA_PACKAGES, "tdms", ("no_such_module", "npTDMS", "TDMS"))
        with pytest.raises(MissingExtraError, match="missing-package"):
            write_recording(recording(), tmp_path / "r.tdms")


class TestFaultyFiles:
    @pytest.mark.parametrize(
        ("text", "place"),
        [
            ("", "r.csv:1:1 wrong-file"),
            ("a;b\nc;d\n", "r.csv:1:1 wrong-file"),
            ("time,T [Nm]\n0,1\n1,x\n2,3\n3,4\n", "r.csv:3:3 not-a-number"),
            ("time,T [Nm]\n0,1\n1,2\n2\n3,4\n", "r.csv:4:1 wrong-count"),
            ("time,T [Nm]\n0,1\n1,2\n2,3,5\n3,4\n", "r.csv:4:1 wrong-count"),
            ("time,T [Nm]\n0,1\n2,1\n1,1\n", "r.csv:4:1 unordered-rows"),
            ("time,T [Nm]\n0,1\n1,2\n2,\n", "unlike-results"),
            ("T [Nm]\n1\n2\n", "missing-entry"),
            ("time,T [Nm]\n0,1\n", "missing-entry"),
            ("time,T [V]\n0,1\n1,2\n", "r.csv:1:6 missing-unit"),
            ("time,T\n0,1\n1,2\n", "r.csv:1:6 missing-unit"),
            ("time;M [Nm];  T\n0;1;2\n1;2;3\n", "r.csv:1:15 missing-unit"),
            ("time,M,T\ns,Nm,-\n0,1,2\n1,2,3\n", "r.csv:2:6 missing-unit"),
            ("time,M [Nm]\n0,1\n1,2\n", "channels unknown-channel"),
        ],
    )
    def test_is_told(self, tmp_path, text, place):
        file = write(tmp_path, text)
        assert placed_faults(lambda: read_recording(file, names=["T"])) == [place]

    def test_all_faults_at_once(self, tmp_path):
        with pytest.raises(ModelError) as caught:
            read_recording(write(tmp_path, "time,T [Nm]\n0,1\n1,x\n2,y\n3\n4,5\n"))
        assert [fault.position.line for fault in caught.value.faults] == [3, 4, 5]

    def test_unit_of_another_quantity(self, tmp_path):
        path = write(tmp_path, "time,T [deg]\n0,1\n1,2\n")
        with pytest.raises(ModelError, match=r":1:6: .*wrong-unit"):
            read_recording(path, {"T": "torque"})

    def test_a_file_is_closed_though_it_is_not_read_to_its_end(self, tmp_path, monkeypatch):
        """With one reference left to a member an archive stays open, until chance collects it and warns of it."""
        members, plain = [], zipfile.ZipFile.open

        def kept(*arguments, **options):
            members.append(plain(*arguments, **options))
            return members[-1]

        np.savez(tmp_path / "r.npz", a=np.zeros(5), b=np.zeros(5), fs=1.0)
        monkeypatch.setattr(zipfile.ZipFile, "open", kept)
        with npz.open_source(tmp_path / "r.npz"):
            assert any(not member.closed for member in members)
        assert all(member.closed for member in members)

    def test_unequal_lengths_of_arrays(self, tmp_path):
        np.savez(tmp_path / "r.npz", a=np.zeros(5), b=np.zeros(7), c=np.zeros(7), fs=1.0)
        with pytest.raises(ModelError, match="unlike-results"):
            read_recording(tmp_path / "r.npz")

    @pytest.mark.parametrize("ending", [ending for ending in ENDINGS if ending != ".csv"])
    @pytest.mark.parametrize("content", [b"", b"rubbish" * 100])
    def test_rubbish_is_no_traceback(self, tmp_path, ending, content):
        needs(ending)
        path = tmp_path / f"r{ending}"
        path.write_bytes(content)
        with pytest.raises(ModelError):
            read_recording(path)

    def test_rate_against_stamps(self, tmp_path):
        path = write(tmp_path, "time,T [Nm]\n0,1\n1,2\n")
        with pytest.raises(ModelError, match="contradicting-values"):
            read_recording(path, sampling_rate=2.0)

    def test_unknown_ending_and_missing_file(self, tmp_path):
        with pytest.raises(UsageError, match=r'did you mean "\.tdms"'):
            read_recording(tmp_path / "r.tdmz")
        with pytest.raises(UsageError, match="there is no file"):
            read_recording(tmp_path / "r.csv")


@pytest.mark.slow
@given(
    separator=st.sampled_from([";", ",", "\t", " "]),
    decimal=st.sampled_from([".", ","]),
    newline=st.sampled_from(["\n", "\r\n"]),
    heading=st.booleans(),
    rows=st.lists(st.tuples(*[st.floats(-1e6, 1e6).map(lambda x: x + 0.5)] * 3), min_size=3, max_size=8),
)
def test_any_dialect_is_read(tmp_path_factory, separator, decimal, newline, heading, rows):
    assume(separator != decimal)
    lines = [separator.join(["a[Nm]", "b[Nm]", "c[Nm]"])] if heading else []
    lines += [separator.join(f"{value!r}".replace(".", decimal) for value in row) for row in rows]
    path = tmp_path_factory.mktemp("dialect") / "r.txt"
    path.write_bytes((newline.join(lines) + newline).encode())
    found = read_recording(path, sampling_rate=1.0)
    np.testing.assert_array_equal(np.array([signal.values for signal in found]).T, np.array(rows))


def one(values, quantity="torque", times=None, name="x"):
    rate = RATE if times is None else (len(times) - 1) / (times[-1] - times[0])
    return Recording((Signal(name, quantity, np.asarray(values, dtype=float)),), rate, times=times)


def sine(amplitude=1.0):
    return amplitude * np.sin(2 * np.pi * 5 * TIME)


def with_values(at, value):
    values = sine()
    values[at] = value
    return values


JITTERED = TIME + 1e-4 * np.random.default_rng(2).uniform(-1, 1, len(TIME))
GAPPED = np.delete(TIME, slice(1000, 1500))
LOST = np.delete(TIME, [1000, 2000, 2001])
ANGLE, LEAPING = np.arange(5000) * 0.01, (np.arange(5000) + 3 * (np.arange(5000) > 1000)) * 0.01
TWICE = Recording((Signal("x", "torque", sine()), Signal("x", "torque", sine())), RATE)
BACKWARDS = with_values(3, 0.0) * 0 + np.r_[TIME[:3], 0.001, TIME[4:]]
FAULTS = {  # severity, place, values and kind of all that is said for windows of 2 s, beside that these are few
    "nan": (one(with_values(slice(1000, 1003), np.nan)), r"channels\.x: error: 3 .* 1 to 1\.002 s.*\[not-finite\]"),
    "inf": (one(with_values(1000, np.inf)), r"channels\.x: error: 1 .* 1 s.*\[not-finite\]"),
    # 2 |sin| >= 1.5 holds for 47 of the 100 samples of each of 50 half periods.
    "clipped": (one(np.clip(sine(2.0), -1.5, 1.5)), r"channels\.x: error: .*2350 .*1\.5 N\*m.* 0\.027 to 0\.073 s, .* 0\.127 to 0\.173 s, .* 0\.227 to 0\.273 s.* 47 .*\[disturbed-signal\]"),
    "constant": (one(np.full(5000, 2.0)), r"channels\.x: warning: .* 2 N\*m.*\[disturbed-signal\]"),
    "short": (one(sine()[:1500]), r"channels: error: .*1\.5 s.* 2 s.*\[too-short\]"),
    "gap": (one(sine()[: len(GAPPED)], times=GAPPED), r"time: error: 1 gap .*0\.501 s .*0\.999 s.*\[uneven-samples\]"),
    "gaps": (one(sine()[: len(LOST)], times=LOST), r"time: error: 2 gaps .*0\.002 s .*0\.999 s, 0\.003 s .*1\.999 s.*\[uneven-samples\]"),
    # Differences of two uniform numbers between -0.1 and 0.1 ms scatter by sqrt(2/3) of that.
    "jitter": (one(sine(), times=JITTERED), r"time: warning: .*8\.2 %.*\[uneven-samples\]"),
    "jitter of a ramp": (one(ANGLE, times=JITTERED), r"time: warning: .*8\.2 %.*\[uneven-samples\]"),
    "backwards": (one(sine(), times=BACKWARDS), r"time: error: .*0\.001 s .*0\.002 s.*\[unordered-rows\]"),
    "quantity": (one(sine(), ""), r'channels\.x: error: .*\{"x": "torque"\}.*\[missing-unit\]'),
    "unknown quantity": (one(sine(), "force"), r'channels\.x: error: .*"force".*\[unknown-word\]'),
    # The angle passes 2 pi at 0.314 s.
    "wrap": (one(np.mod(20 * TIME, 2 * np.pi), "angle"), r"channels\.x: error: .*15 .*6\.263 rad.* 0\.314 s.*\[wrapped-count\]"),
    "pulses": (one(ANGLE[: len(LOST)], "angle", LOST), r"time: error: 3 .*1 after 0\.999 s, 2 after 1\.999 s.*\[lost-pulses\]"),
    "leap": (one(LEAPING, "angle"), r"channels\.x: warning: .* 1\.001 s.*\[lost-pulses\]"),
    "names": (TWICE, r"channels\.x: error: 2 .*\[repeated-name\]"),
}  # fmt: skip
FEW = r"channels: warning: .*2\.5 .* 2 s.*\[too-short\]"


@pytest.mark.parametrize("fault", FAULTS)
def test_check_tells(fault):
    given, told = FAULTS[fault]
    patterns = [told] if fault == "short" else [told, FEW]
    faults = {str(found) for found in check_recording(given)}
    assert len(faults) == len(patterns)
    assert [sum(re.fullmatch(pattern, text) is not None for text in faults) for pattern in patterns] == [1] * len(
        patterns
    )


def test_steps_that_are_no_whole_numbers_of_the_smallest_are_not_those_of_an_encoder():
    steps = np.where(np.arange(40) == 20, 0.25, 0.05)
    assert encoder_leaps(np.cumsum(steps)).tolist() == [20]
    assert not len(encoder_leaps(np.cumsum(steps * (1 + 0.03 * (np.arange(40) % 2)))))


@pytest.mark.parametrize(("windows", "said"), [(4, 0), (3.9, 1)])
def test_how_many_windows_are_few(windows, said):
    assert len(check_recording(one(sine()), seconds=5 / windows)) == said


def test_one_window_is_no_error():
    (fault,) = check_recording(one(sine()[:2000]))
    assert fault.severity == "warning"


def test_errors_come_first():
    severities = [fault.severity for fault in check_recording(one(with_values(3, np.nan), times=JITTERED))]
    assert severities == ["error", "warning", "warning"]


def test_stamped_pulses_of_a_speed_that_changes_are_no_jitter():
    """Every sample is a step further, however few there are."""
    for count in (3, 4, 50):
        times = np.cumsum(np.linspace(1.0, 1.3, count))
        found = check_recording(one(0.01 * np.arange(count), "angle", times), seconds=0.1)
        assert found == ()


@pytest.mark.parametrize(
    "values",
    [
        sine(),
        np.round(sine() * 8) / 8,
        np.round(sine(0.5) * 512) / 512,
        np.random.default_rng(3).normal(size=5000),
        np.concatenate([np.zeros(500), sine()[500:]]),
        np.sign(sine() + 1e-9),
    ],
)
@pytest.mark.parametrize("quantity", ["torque", "angle"])
def test_check_finds_nothing_in_sound_signals(values, quantity):
    assert check_recording(one(values, quantity), seconds=0.5) == ()


def test_check_with_a_range_given():
    texts = [fault.message for fault in check_recording(one(sine()), seconds=0.5, ranges={"x": 0.999})]
    assert len(texts) == 1
    assert texts[0].startswith("clipped: ")


@pytest.mark.parametrize("rate", [0.0, -1.0, np.inf, np.nan])
def test_sampling_rate_is_positive(rate):
    with pytest.raises(UsageError, match="out-of-range"):
        Recording((Signal("x", "torque", np.zeros(3)),), rate)


class TestEncoder:
    def test_counter_of_sixteen_bits(self):
        counts = np.arange(200_000)[::7]
        angle = angle_from_counts(counts % 2**16, 4096, bits=16)
        np.testing.assert_allclose(angle, counts * 2 * np.pi / 4096, rtol=1e-12)

    def test_unwrapped_both_ways(self):
        angle = 15 * np.sin(2 * np.pi * TIME)
        found = unwrapped(Signal("phi", "angle", np.mod(angle, 2 * np.pi)))
        np.testing.assert_allclose(found.values, angle, atol=1e-12)

    def test_pulses_of_a_speed_that_changes(self):
        angle = np.arange(400) * 2 * np.pi / 100
        times = np.sqrt(angle + 1.0)  # angle = t^2 - 1
        kept = np.delete(times, [50, 200, 201])
        lost = missing_pulses(kept)
        assert list(zip(lost.after.tolist(), lost.counts.tolist(), strict=True)) == [(49, 1), (198, 2)]
        with pytest.warns(TorsionnetWarning, match="3 pulses missing and counted: 1 after pulse 49 at "):
            found, start = angle_from_pulses(kept, 100, sampling_rate=50.0)
        time = start + np.arange(len(found)) / 50.0
        np.testing.assert_allclose(found, time**2 - 1, atol=1e-6)


class TestResampled:
    def test_follows_the_signal(self):
        found = resampled(one(np.sin(2 * np.pi * 5 * JITTERED), times=JITTERED))
        assert found.times is None
        np.testing.assert_allclose(found["x"].values, np.sin(2 * np.pi * 5 * found.time), atol=1e-6)

    @pytest.mark.parametrize(
        ("given", "rate", "message"),
        [
            (FAULTS["gap"][0], None, "uneven-samples"),
            (FAULTS["nan"][0], 2000.0, "not-finite"),
            (FAULTS["jitter"][0], 100.0, "out-of-range"),
        ],
    )
    def test_refuses(self, given, rate, message):
        with pytest.raises(UsageError, match=message):
            resampled(given, rate)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ending", "samples"), [(".npz", 2_000_000), (".h5", 2_000_000), (".tdms", 2_000_000), (".csv", 600_000)]
)
def test_blocks_of_a_large_file_take_little_memory(tmp_path, ending, samples):
    needs(ending)
    values = np.arange(samples, dtype=float)
    path = tmp_path / f"r{ending}"
    write_recording(Recording((Signal("a", "torque", values), Signal("b", "angle", -values)), 1e4), path)
    assert path.stat().st_size > 12e6
    tracemalloc.start()
    total = sum(float(block["b"].values.sum()) for block in iter_blocks(path, 2.0))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert total == -samples * (samples - 1) / 2
    assert peak < 5e6


@pytest.mark.parametrize("quantity", ["angle", "velocity", "torque"])
def test_a_record_of_one_sample_is_too_short_and_nothing_else(quantity):
    (fault,) = check_recording(Recording((Signal("phi", quantity, np.array([2.5])),), sampling_rate=1000.0))
    assert "less than one window" in str(fault)


def test_a_time_stamp_next_to_zero_divides_nothing(tmp_path):
    """The smallest number there is, as in a file whose exponent was spoilt."""
    stamps = [*(f"{0.001 * count:.3f}" for count in range(16)), "4.94065646e-324", "0.017"]
    path = tmp_path / "record.csv"
    path.write_text("\n".join(["time [s],T [N*m]", *(f"{stamp},1.5" for stamp in stamps)]), encoding="utf-8")
    with pytest.raises(ModelError, match=r":18:1: .*324.*0\.015.*unordered-rows"):
        read_recording(path)


def test_a_step_is_a_wrap_where_it_spans_nearly_the_whole_range():
    """Of an angle over 40 rad a step of 6 rad is lost samples; of one over 2 pi it is the encoder that begins again."""
    whole = np.concatenate([np.linspace(0, 20, 200), np.linspace(26, 40, 140)])
    assert not len(wrap_jumps(whole)[0])
    places, size = wrap_jumps(np.linspace(0, 40, 400) % 6)
    assert len(places) == 6
    assert size == pytest.approx(6 - 40 / 399, rel=1e-9)
