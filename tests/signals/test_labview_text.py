"""Text files of LabVIEW: rates, names and segments from their headers, and what is said of faulty ones."""

import json

import numpy as np
import pytest
from support.command_line import run

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.signals.records.recording_files import iter_blocks, read_recording, write_recording
from torsionnet.signals.resampling import blocks_in_order

FILE = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
    "Multi_Headings\tYes\nX_Columns\tNo\nTime_Pref\tRelative\nOperator\tbench\n"
    "Date\t2024/05/03\nTime\t10:12:13.001\n***End_of_Header***\t\n\t\n"
)
COUNT = 40
T, PHI = np.round(np.sin(np.arange(COUNT)), 6), np.round(np.cos(np.arange(COUNT)), 6)


def segment(first=0, last=COUNT, x0=0.0, clock="10:12:13.001", interval="0.001", **changed):
    entries = {
        "Channels": ["2"],
        "Samples": [str(last - first)] * 2,
        "Date": ["2024/05/03"] * 2,
        "Time": [clock] * 2,
        "Y_Unit_Label": ["kNm", "deg"],
        "X_Dimension": ["Time"] * 2,
        "X0": [f"{x0:.6E}"] * 2,
        "Delta_X": [interval] * 2,
    } | changed
    head = "".join("\t".join([key, *cells]) + "\t\n" for key, cells in entries.items() if cells)
    rows = "".join(f"\t{T[at]:.6f}\t{PHI[at]:.6f}\n" for at in range(first, last))
    return f"{head}***End_of_Header***\t\t\t\nX_Value\tTorque\tAngle\tComment\n{rows}"


def write(tmp_path, text, name="r.lvm"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def with_times(text, step=0.001, start=0.0):
    """The same with a column of times."""
    lines, row = text.splitlines(keepends=True), 0
    for at, line in enumerate(lines):
        if line.startswith("\t") and line.strip():
            lines[at] = f"{start + row * step:.6f}{line}"
            row += 1
    return "".join(lines).replace("X_Columns\tNo", "X_Columns\tOne")


class TestSound:
    def test_rate_names_and_units_from_the_header(self, tmp_path):
        found = read_recording(write(tmp_path, FILE + segment(x0=2.0)))
        assert (found.names, found.sampling_rate, found.start) == (("Torque", "Angle"), 1000.0, 2.0)
        np.testing.assert_array_equal(found["Torque"].values, 1000 * T)
        assert found["Angle"].values == pytest.approx(np.radians(PHI))
        assert found.times is None
        assert "LabVIEW header: cells between tabs, decimal point" in found.notes
        assert "begins at 2024/05/03 10:12:13.001, as the header says" in found.notes
        assert not any("warning" in note or "empty" in note for note in found.notes)

    @pytest.mark.parametrize("ending", ["", "\tstart\n"])
    def test_comments_are_passed_over_and_told_where_there_are_any(self, tmp_path, ending):
        text = FILE + segment()
        at = text.index("\n", text.index("Comment\n") + 8)
        found = read_recording(write(tmp_path, text[:at] + ending.rstrip("\n") + text[at:]))
        assert len(found) == COUNT
        assert ("the column of comments was passed over" in found.notes) == bool(ending)

    def test_decimal_commas(self, tmp_path):
        text = (FILE + segment(interval="0,001")).replace("Decimal_Separator\t.", "Decimal_Separator\t,")
        head, data = text.split("Comment\n")
        found = read_recording(write(tmp_path, f"{head}Comment\n{data.replace('.', ',')}"))
        np.testing.assert_array_equal(found["Torque"].values, 1000 * T)
        assert found.sampling_rate == 1000.0

    def test_commas_between_cells(self, tmp_path):
        text = (FILE + segment()).replace("\t", ",").replace("Separator,Tab", "Separator,Comma")
        assert read_recording(write(tmp_path, text))["Torque"].values[5] == 1000 * T[5]

    def test_a_column_of_times_that_agrees(self, tmp_path):
        found = read_recording(write(tmp_path, with_times(FILE + segment(), start=1.0)))
        assert (found.names, found.sampling_rate, found.start) == (("Torque", "Angle"), 1000.0, 1.0)

    def test_a_column_of_times_for_every_channel(self, tmp_path):
        text = FILE + segment()
        text = text.replace("X_Value\tTorque\tAngle", "X_Value\tTorque\tX_Value\tAngle")
        head, data = text.split("Comment\n")
        rows = [line.split("\t") for line in data.splitlines()]
        times = [f"{0.001 * at:.3f}" for at in range(COUNT)]
        lines = [f"{time}\t{row[1]}\t{time}\t{row[2]}\n" for time, row in zip(times, rows, strict=True)]
        found = read_recording(write(tmp_path, f"{head}Comment\n{''.join(lines)}"))
        assert (found.names, found.sampling_rate) == (("Torque", "Angle"), 1000.0)
        lines[7] = lines[7].replace("\t0.007", "\t0.0072")
        with pytest.raises(ModelError, match=r":23:1: .*unlike-results"):
            read_recording(write(tmp_path, f"{head}Comment\n{''.join(lines)}"))

    def test_an_export_without_the_first_line(self, tmp_path):
        for head in ("Delta_X\t0.001\n", "Channels\t2\nDelta_X\t0.001\t0.001\n***End_of_Header***\n"):
            rows = "".join(f"\t{T[at]}\t{PHI[at]}\n" for at in range(COUNT))
            found = read_recording(write(tmp_path, f"{head}X_Value\tM [Nm]\tphi [deg]\n{rows}", "r.txt"))
            assert (found.names, found.sampling_rate) == (("M", "phi"), 1000.0)
            np.testing.assert_array_equal(found["M"].values, T)

    def test_special_blocks_are_passed_over(self, tmp_path):
        text = FILE + segment()
        at = text.rindex("\n", 0, len(text) - 60) + 1
        special = "***Start_Special***\nNotes\t1.0\n***End_Special***\n"
        assert len(read_recording(write(tmp_path, text[:at] + special + text[at:]))) == COUNT
        at = text.index("Channels")
        assert len(read_recording(write(tmp_path, text[:at] + special + text[at:]))) == COUNT

    def test_another_ending_does_not_matter(self, tmp_path):
        assert read_recording(write(tmp_path, FILE + segment(), "r.txt")).sampling_rate == 1000.0

    def test_is_not_written(self, tmp_path):
        record = read_recording(write(tmp_path, FILE + segment()))
        with pytest.raises(UsageError, match="wrong-file"):
            write_recording(record, tmp_path / "new.lvm")


class TestSegments:
    @pytest.mark.parametrize(
        "second",
        [segment(20, COUNT, x0=0.02), segment(20, COUNT, clock="10:12:13.021")],
        ids=["X0 goes on", "the time of day goes on"],
    )
    def test_are_joined(self, tmp_path, second):
        path = write(tmp_path, f"{FILE}{segment(0, 20)}\t\n{second}")
        found = read_recording(path)
        np.testing.assert_array_equal(found["Torque"].values, 1000 * T)
        assert "2 segments that follow each other were joined" in found.notes
        blocks = list(iter_blocks(path, 0.015))
        assert [len(block) for block in blocks] == [15, 15, 10]
        assert [block.start for block in blocks] == pytest.approx([0, 0.015, 0.03])

    @pytest.mark.parametrize(
        ("second", "message"),
        [
            (segment(20, COUNT, x0=0.02, interval="0.002"), r":54:1: .*unlike-results"),
            (segment(20, COUNT, x0=0.02, Y_Unit_Label=["Nm", "deg"]), r":54:1: .*23.*unlike-results"),
        ],
    )
    def test_of_other_channels_are_refused(self, tmp_path, second, message):
        with pytest.raises(ModelError, match=message):
            read_recording(write(tmp_path, f"{FILE}{segment(0, 20)}\t\n{second}"))


def rows(values, times=None):
    """Rows of one header for all of the values."""
    at = "" if times is None else None
    return "".join(
        f"{at if times is None else f'{times[i]:.6f}'}\t{x:.6f}\t{y:.6f}\n" for i, (x, y) in enumerate(values)
    )


HEADED = FILE + segment(0, 20)[: segment(0, 20).index("Comment\n") + 8]
RANDOM = np.round(np.random.default_rng(4).normal(size=(60, 2)), 6)
RESTART = np.tile(np.arange(20) * 0.001, 3)
TRIGGERED = {
    "rows beyond Samples": HEADED + rows(RANDOM),
    "times that begin anew": (HEADED + rows(RANDOM, RESTART)).replace("X_Columns\tNo", "X_Columns\tOne"),
    "times with gaps": (HEADED + rows(RANDOM, RESTART + np.repeat([0, 1, 2.5], 20))).replace("Columns\tNo", "Columns\tOne"),
    "headers again": HEADED + f"\t\n{HEADED[len(FILE) :]}".join(rows(RANDOM[at : at + 20]) for at in (0, 20, 40)),
    "headers of a later time": HEADED + f"\t\n{HEADED[len(FILE) :]}".replace("12:13", "12:15").join(rows(RANDOM[at : at + 20]) for at in (0, 20, 40)),
}  # fmt: skip


class TestBlocksAfterTriggers:
    @pytest.mark.parametrize("case", TRIGGERED)
    @pytest.mark.parametrize("seconds", [1.0, 0.013])
    def test_are_kept_apart(self, tmp_path, case, seconds):
        blocks = list(iter_blocks(write(tmp_path, TRIGGERED[case]), seconds))
        assert [len(block) for block in blocks] == ([20] * 3 if seconds == 1.0 else [13, 7] * 3)
        np.testing.assert_array_equal(np.concatenate([block["Torque"].values for block in blocks]), 1000 * RANDOM[:, 0])
        assert {block.sampling_rate for block in blocks} == {1000.0}
        follows = [continued for _, continued in blocks_in_order(blocks)]
        assert follows == ([False] * 3 if seconds == 1.0 else [False, True] * 3)

    @pytest.mark.parametrize("case", TRIGGERED)
    def test_are_no_single_record(self, tmp_path, case):
        path = write(tmp_path, TRIGGERED[case])
        with pytest.raises(ModelError, match=r"(?s)20.*unlike-results"):
            read_recording(path)
        result = run("spectrogram", path, "--seconds", "0.01", code=1)
        assert "3 blocks that do not follow each other" in result.stderr
        assert "iter_blocks" not in result.stderr

    @pytest.mark.parametrize("case", TRIGGERED)
    def test_are_averaged_as_such(self, tmp_path, case):
        from scipy.signal import csd

        torque, angle = 1000 * RANDOM[:, 0].reshape(3, 20), np.radians(RANDOM[:, 1].reshape(3, 20))
        given = {"fs": 1000, "window": "hamming", "nperseg": 10, "noverlap": 5, "detrend": "constant"}
        over, under = (np.mean(csd(torque, y, axis=1, **given)[1], axis=0) for y in (angle, torque))
        settings = ["--seconds", "0.01", "--overlap", "0.5", "--json"]
        result = run("estimate", write(tmp_path, TRIGGERED[case]), "--input", "Torque", "--output", "Angle", *settings)
        (found,) = json.loads(result.stdout)["responses"]
        assert "note: 3 blocks that do not follow each other, as after a trigger" in result.stderr
        expected = (over / under)[1 : 1 + len(found["real"])]
        assert np.array(found["real"]) + 1j * np.array(found["imag"]) == pytest.approx(expected, rel=1e-9)

    def test_are_kept_apart_without_delta_x_too(self, tmp_path):
        text = "".join(one for one in (HEADED + rows(RANDOM)).splitlines(True) if not one.startswith("Delta_X"))
        blocks = list(iter_blocks(write(tmp_path, text), 1.0, sampling_rate=500.0))
        assert [(len(block), block.start, block.sampling_rate) for block in blocks] == [(20, 0.0, 500.0)] * 3

    def test_packets_whose_times_go_on_are_one_record(self, tmp_path):
        text = (HEADED + rows(RANDOM, np.arange(60) * 0.001)).replace("X_Columns\tNo", "X_Columns\tOne")
        found = read_recording(write(tmp_path, text))
        assert (len(found), found.sampling_rate, found.times) == (60, 1000.0, None)

    def test_samples_written_one_by_one_are_one_record(self, tmp_path):
        assert (
            len(read_recording(write(tmp_path, HEADED.replace("Samples\t20\t20", "Samples\t1\t1") + rows(RANDOM))))
            == 60
        )

    def test_a_cut_block_is_told(self, tmp_path):
        with pytest.raises(ModelError, match=r":74:1: .*20.*11.*truncated-file"):
            list(iter_blocks(write(tmp_path, HEADED + rows(RANDOM[:51])), 1.0))

    def test_pulses_of_several_blocks_are_refused(self, tmp_path):
        with pytest.raises(ModelError, match="unlike-results"):
            read_recording(write(tmp_path, TRIGGERED["rows beyond Samples"]), pulses={"Torque": 60})


WHOLE = FILE + segment()
HOSTILE = {
    "no end of the file's header": (WHOLE.replace("***End_of_Header***\t\n", "", 1), r":13:1: .*wrong-file"),
    "no end of the channels' header": (WHOLE.replace("***End_of_Header***\t\t\t\n", ""), r":22:1: .*wrong-file"),
    "no end at all": (WHOLE.replace("***End_of_Header***", ""), r"End_of_Header\*\*\* .*wrong-file"),
    "a header alone": (FILE, r":13:1: .*wrong-file"),
    "no row of names": (WHOLE.replace("X_Value\tTorque\tAngle\tComment\n", ""), r":23:1: .*wrong-file"),
    "Delta_X of 0": (FILE + segment(interval="0"), r":21:9: .* 0 s.*out-of-range"),
    "Delta_X below 0": (FILE + segment(interval="-0.001"), r":21:9: .* -0\.001 s.*out-of-range"),
    "Delta_X as text": (FILE + segment(interval="fast"),  r':21:9: .*"fast".*not-a-number'),
    "Delta_X of nan": (FILE + segment(interval="NaN"),  r':21:9: .*"NaN".*not-a-number'),
    "no Delta_X": (FILE + segment(Delta_X=[]), "missing-entry"),
    "two Delta_X": (FILE + segment(Delta_X=["0.001", "0.002"]), r":21:15: .*0\.001.*0\.002.*unlike-results"),
    "two X0": (FILE + segment(X0=["0", "0.5"]), r":20:6: .*0\.5.*unlike-results"),
    "two Time": (FILE + segment(Time=["10:12:13.001", "10:12:13.251"]), r":17:19: .*10.*12.*unlike-results"),
    "Channels": (FILE + segment(Channels=["3"]), r":23:1: .*14.*wrong-count"),
    "Channels as text": (FILE + segment(Channels=["two"]), r":14:10: .*not-a-number"),
    "Samples beyond all": (FILE + segment(Samples=["1e999"]), r":15:9: .*not-a-number"),
    "columns too many": (WHOLE + "\t1\t2\t\t5\n", r":64:1: .*wrong-count"),
    "columns too few": (WHOLE + "\t1\n", r":64:1: .*wrong-count"),
    "early end": (WHOLE[: WHOLE.rindex("\n", 0, -1) + 1], r":62:1: .*40.*39.*truncated-file"),
    "early end in a row": (WHOLE[:-12], r":63:1: .*truncated-file"),
    "a spectrum": (FILE + segment(X_Dimension=["Frequency"] * 2), r":19:13: .* Frequency.*wrong-file"),
    "a word": (WHOLE.replace("\t0.000000\t", "\tx\t"), r":24:2: .*not-a-number"),
    "commas": (WHOLE.replace("0.841471", "0,841471"), r":25:2: .*841471.*not-a-number"),
    "a separator": (WHOLE.replace("Separator\tTab", "Separator\tBlank"), r":4:1: .*unknown-word"),
    "a decimal sign": (WHOLE.replace("Separator\t.", "Separator\t;"), r':5:1: .*";".*unknown-word'),
    "X_Value against Delta_X": (with_times(WHOLE, 0.002), r":21:9: .*0\.001.*0\.002.*contradicting-values"),
    "X_Value falls back": (with_times(WHOLE).replace("0.030000\t", "0.020000\t"), r":54:1: .*0\.02.*0\.029.*unordered-rows"),
}  # fmt: skip


@pytest.mark.parametrize("case", HOSTILE)
def test_faulty_files_are_refused_with_their_place(tmp_path, case):
    text, message = HOSTILE[case]
    with pytest.raises(ModelError, match=message):
        read_recording(write(tmp_path, text))


def test_the_rate_may_be_said_against_delta_x(tmp_path):
    path = write(tmp_path, with_times(WHOLE, 0.002))
    assert read_recording(path, sampling_rate=500.0).sampling_rate == 500.0


def test_exit_code_and_place_on_the_command_line(tmp_path):
    path = write(tmp_path, FILE + segment(interval="0"))
    result = run("estimate", path, "--input", "Torque", "--output", "Angle", code=1)
    assert "r.lvm:21:9: error: " in result.stderr


def test_any_cut_is_a_message_or_a_record(tmp_path):
    path = tmp_path / "r.lvm"
    for end in range(0, len(WHOLE), 37):
        path.write_text(WHOLE[:end])
        with pytest.raises(ModelError):
            read_recording(path)
