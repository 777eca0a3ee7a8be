"""Files of further kinds: WAV, universal files of other things, responses in MAT files, and what to export instead."""

import re
import wave
from pathlib import Path

import numpy as np
import pytest
from support.command_line import run

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.io import read_frequency_response
from torsionnet.signals.formats.record_uff import function_dataset, write_sets
from torsionnet.signals.formats.registry import EXPORTS, FORMATS
from torsionnet.signals.recording import Recording, Signal
from torsionnet.signals.records.recording_files import iter_blocks, read_recording, write_recording

RANDOM = np.random.default_rng(0)
FREQUENCIES = np.arange(1.0, 51.0)
RESPONSE = 1 / (1000 - 0.1 * (2 * np.pi * FREQUENCIES) ** 2 + 8j * np.pi * FREQUENCIES)


def write_wav(path, numbers, size, rate=51_200):
    """Whole numbers (n, channels) of so many bytes, through the standard library."""
    with wave.open(str(path), "wb") as file:
        file.setnchannels(numbers.shape[1])
        file.setsampwidth(size)
        file.setframerate(rate)
        file.writeframes(b"".join(int(one).to_bytes(size, "little", signed=size > 1) for one in numbers.ravel()))


class TestWav:
    @pytest.mark.parametrize("size", [1, 2, 3, 4])
    def test_whole_numbers_of_any_size(self, tmp_path, size):
        half = 2 ** (8 * size - 1)
        numbers = RANDOM.integers(0 if size == 1 else -half, 256 if size == 1 else half, (50, 2))
        write_wav(tmp_path / "r.wav", numbers, size)
        found = read_recording(tmp_path / "r.wav")
        assert (found.names, found.sampling_rate, found.start) == (("channel_1", "channel_2"), 51_200.0, 0.0)
        np.testing.assert_array_equal([signal.values for signal in found], numbers.T)
        assert f"whole numbers of {8 * size} bits, full scale is {half}" in found.signals[0].notes[0]
        blocks = list(iter_blocks(tmp_path / "r.wav", 20 / 51_200))
        np.testing.assert_array_equal(np.concatenate([block["channel_2"].values for block in blocks]), numbers[:, 1])

    @pytest.mark.parametrize("notes", [b"x" * 8000, b"how to set the fmt of files", b""])
    def test_notes_of_a_recorder_before_the_format(self, tmp_path, notes):
        """A chunk ``bext``, as in Broadcast WAV files."""
        numbers = RANDOM.integers(-(2**23), 2**23, (50, 2))
        write_wav(tmp_path / "r.wav", numbers, 3)
        whole, padded = (tmp_path / "r.wav").read_bytes(), notes + b"\0" * (len(notes) % 2)
        body = b"WAVEbext" + len(notes).to_bytes(4, "little") + padded + whole[12:]
        (tmp_path / "r.wav").write_bytes(b"RIFF" + len(body).to_bytes(4, "little") + body)
        found = read_recording(tmp_path / "r.wav")
        np.testing.assert_array_equal([signal.values for signal in found], numbers.T)

    def test_numbers_with_a_decimal_point(self, tmp_path):
        from scipy.io import wavfile

        values = RANDOM.normal(size=(50, 3)).astype(np.float32)
        wavfile.write(tmp_path / "r.wav", 44_100, values)
        np.testing.assert_array_equal([signal.values for signal in read_recording(tmp_path / "r.wav")], values.T)

    def test_a_damaged_file_is_a_message(self, tmp_path):
        write_wav(tmp_path / "r.wav", RANDOM.integers(-99, 99, (50, 1)), 2)
        whole = (tmp_path / "r.wav").read_bytes()
        for end in range(0, len(whole) - 1, 7):
            (tmp_path / "r.wav").write_bytes(whole[:end])
            with pytest.raises(ModelError, match="unreadable-file"):
                read_recording(tmp_path / "r.wav")

    def test_is_not_written(self, tmp_path):
        record = Recording((Signal("T", "torque", np.ones(3)),), sampling_rate=10.0)
        with pytest.raises(UsageError, match="wrong-file"):
            write_recording(record, tmp_path / "r.wav")


@pytest.mark.parametrize("ending", [ending for endings in EXPORTS for ending in endings])
def test_what_is_not_read_says_which_export_to_make(tmp_path, ending):
    (tmp_path / f"r{ending}").touch()
    result = run("estimate", tmp_path / f"r{ending}", "--input", "T", "--output", "a", code=2)
    words = next(export for endings, (_, export) in EXPORTS.items() if ending in endings)
    assert f"is not read here; export it there {words}" in result.stderr
    readable = {known for form in FORMATS for known in form.endings} | {"CSV", "ASCII", "TDMS", "text"}
    assert readable & set(re.findall(r"\.\w+|\w+", words))


def test_the_docs_list_every_ending():
    page = (Path(__file__).parents[2] / "docs/test_bench.md").read_text(encoding="utf-8")
    known = [*(ending for form in FORMATS for ending in form.endings), *(ending for some in EXPORTS for ending in some)]
    assert [ending for ending in known if f"`{ending}`" not in page] == []


def mesh():
    return {"type": 15, "node_nums": [1, 2], "def_cs": [0, 0], "disp_cs": [0, 0], "color": [1, 1],
            "x": [0.0, 1.0], "y": [0.0, 0.0], "z": [0.0, 0.0]}  # fmt: skip


def function(kind):
    return function_dataset(
        ["a"], func_type=kind, rsp_node=1, rsp_dir=1, ref_node=2, ref_dir=1, rsp_ent_name="NONE", ref_ent_name="NONE",
        data=RESPONSE if kind == 4 else np.abs(RESPONSE), x=FREQUENCIES, abscissa_spacing=1, abscissa_min=1.0,
        abscissa_inc=1.0, abscissa_spec_data_type=18, abscissa_axis_units_lab="Hz", ordinate_spec_data_type=12,
        ordinate_axis_units_lab="NONE",
    )  # fmt: skip


UFFS = {
    "a mesh": (lambda: [mesh()], "the file holds nodes of a mesh (data set 15), no record over time"),
    "spectra": (lambda: [mesh(), function(9), function(9)],
                "the file holds nodes of a mesh (data set 15) and 2 power spectral densities (58)"),
    "responses": (lambda: [function(4), function(6)],
                  "the file holds 1 frequency responses (data set 58) and 1 coherences (58), no record over time; fit and report"),
}  # fmt: skip


@pytest.mark.parametrize("case", UFFS)
def test_universal_files_of_other_things_are_named(tmp_path, case):
    sets, message = UFFS[case]
    write_sets(sets(), tmp_path / "r.uff")  # by pyuff
    result = run("estimate", tmp_path / "r.uff", "--input", "T", "--output", "a", code=1)
    assert message in result.stderr
    assert "--sampling-rate" not in result.stderr
    if case != "responses":
        with pytest.raises(ModelError, match="wrong-file"):
            read_frequency_response(tmp_path / "r.uff")


ARRAYS = {
    "one": ({"Freq": FREQUENCIES, "H": RESPONSE}, ["H"], ["input"]),
    "columns": ({"f": FREQUENCIES[:, None], "H": np.stack([RESPONSE, 2 * RESPONSE], 1)}, ["H_1", "H_2"], ["input"]),
    "rows": ({"freq": FREQUENCIES[None], "H": np.stack([RESPONSE, 2 * RESPONSE])}, ["H_1", "H_2"], ["input"]),
    "several": ({"Frequency": FREQUENCIES, "H11": RESPONSE, "H21": 3 * RESPONSE}, ["H11", "H21"], ["input"]),
    "rad/s": ({"omega": 2 * np.pi * FREQUENCIES, "H": RESPONSE}, ["H"], ["input"]),
    "a matrix": ({"Freq": FREQUENCIES, "H": RESPONSE[:, None, None] * [[1, 2, 3], [4, 5, 6]]},
                 ["H_1", "H_2"], ["input_1", "input_2", "input_3"]),
    "a structure": ({"frf": {"Freq": FREQUENCIES, "H": RESPONSE}}, ["frf.H"], ["input"]),
}  # fmt: skip


class TestArraysOfAResponse:
    @pytest.mark.parametrize("case", ARRAYS)
    def test_in_mat_files(self, tmp_path, case):
        from scipy.io import savemat

        content, outputs, inputs = ARRAYS[case]
        savemat(tmp_path / "h.mat", content)
        found = read_frequency_response(tmp_path / "h.mat")
        assert [[one.name for one in side] for side in (found.outputs, found.inputs)] == [outputs, inputs]
        np.testing.assert_allclose(found.frequencies, FREQUENCIES, rtol=1e-15)
        np.testing.assert_array_equal(found.values[:, 0, 0], RESPONSE)
        scales = {"columns": [1, 2], "rows": [1, 2], "several": [1, 3], "a matrix": [1, 4]}.get(case, [1])
        np.testing.assert_array_equal(found.values[:, :, 0], RESPONSE[:, None] * scales)

    def test_are_no_record(self, tmp_path):
        from scipy.io import savemat

        savemat(tmp_path / "h.mat", ARRAYS["one"][0])
        result = run("estimate", tmp_path / "h.mat", "--input", "T", "--output", "a", code=1)
        assert re.search("Freq, H .*unreadable-file", result.stderr)
        assert "--sampling-rate" not in result.stderr

    def test_lines_that_do_not_rise_are_refused(self, tmp_path):
        from scipy.io import savemat

        savemat(tmp_path / "h.mat", {"Freq": FREQUENCIES[::-1], "H": RESPONSE})
        with pytest.raises(ModelError, match="unordered-rows"):
            read_frequency_response(tmp_path / "h.mat")


class TestMessagesOnTheCommandLine:
    """They name options, not arguments of Python, each once, and a likely quantity."""

    def refused(self, tmp_path, text, *more):
        (tmp_path / "r.csv").write_text(text)
        result = run("estimate", tmp_path / "r.csv", "--input", "T", "--output", "phi", *more, code=1)
        assert not re.search(r"\w=(?=[ ,;]| in)|\w\(\)|=True|\{", result.stderr)
        return result.stderr

    def test_an_angle_without_unit_is_no_torque(self, tmp_path):
        rows = "".join(f"{at / 100},{at},1\n" for at in range(50))
        said = self.refused(tmp_path, "t [s],T [Nm],phi\n" + rows)
        assert "for example --quantity phi=angle" in said
        with pytest.raises(ModelError, match=r'(?s)quantities=\{"phi": "angle"\}.*missing-unit'):
            read_recording(tmp_path / "r.csv", names=["phi"])

    def test_no_rate(self, tmp_path):
        said = self.refused(tmp_path, "T [Nm],phi [rad]\n" + "1,2\n" * 50)
        assert re.search("--sampling-rate .*missing-entry", said)

    def test_another_rate(self, tmp_path):
        rows = "".join(f"{at / 100},{at},1\n" for at in range(50))
        assert "--sampling-rate 99 was given" in self.refused(
            tmp_path, "t [s],T [Nm],phi [rad]\n" + rows, "--sampling-rate", "99"
        )

    def test_jitter_names_its_option_once(self, tmp_path):
        times = np.cumsum(RANDOM.uniform(0.5, 1.5, 200)) / 100
        rows = "".join(f"{at!r},1,{at!r}\n" for at in times.tolist())
        assert self.refused(tmp_path, "t [s],T [Nm],phi [rad]\n" + rows).count("--resample") == 1
