"""Structures in MAT files of test systems: Testlab (x_values, y_values) and PULSE (File_Header, Channel_1_Data)."""

import re

import numpy as np
import pytest

from torsionnet.base.errors import ModelError
from torsionnet.signals import read_recording

TIMES = np.arange(400) / 2000


def structure(values, interval=1 / 2000, start=0.5, label="Nm", factor=1.0, name="Shaft:S", **changes):
    """A structure as Testlab exports it; ``changes`` replace entries of x_values, None leaves one out."""
    axis = {"start_value": start, "increment": interval, "number_of_values": float(len(values))} | changes
    quantity = {"label": label, "unit_transformation": {"factor": factor, "offset": 0.0, "log_reference": 0.0}}
    return {
        "x_values": {key: one for key, one in axis.items() if one is not None} | {"quantity": {"label": "s"}},
        "y_values": {"values": np.asarray(values).reshape(len(values), -1), "quantity": quantity},
        "function_record": {"name": name, "type": "Signal"},
    }


def cells(*texts):
    found = np.empty((1, len(texts)), dtype=object)
    found[0, :] = texts
    return found


def saved(tmp_path, content, version):
    path = tmp_path / "run.mat"
    if version == 7:
        from scipy.io import savemat

        savemat(path, content, do_compression=True)
        return path
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in content.items():
            _put(h5py, file, file, name, value)
    return path


def _put(h5py, file, group, name, value):
    """As MATLAB keeps a variable in a file of v7.3: structures as groups, text as numbers, cells as references."""
    if isinstance(value, dict):
        inner = group.create_group(name)
        inner.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, one in value.items():
            _put(h5py, file, inner, key, one)
    elif isinstance(value, str):
        group[name] = np.array([[ord(letter)] for letter in value], dtype=np.uint16)
        group[name].attrs["MATLAB_class"] = np.bytes_("char")
    elif getattr(getattr(value, "dtype", None), "kind", "") == "O":
        references = []
        for one in value.ravel():
            _put(h5py, file, file.require_group("#refs#"), f"r{len(file['#refs#'])}", one)
            references.append(file["#refs#"][f"r{len(file['#refs#']) - 1}"].ref)
        group.create_dataset(name, data=np.array(references, dtype=h5py.ref_dtype).reshape(-1, 1))
        group[name].attrs["MATLAB_class"] = np.bytes_("cell")
    else:
        group[name] = np.atleast_2d(value).T
        group[name].attrs["MATLAB_class"] = np.bytes_("double")


def message(path, **arguments):
    with pytest.raises(ModelError) as caught:
        read_recording(path, **arguments)
    return str(caught.value)


@pytest.mark.parametrize("version", [7, 7.3])
class TestTestlab:
    def test_a_channel_with_name_unit_rate_and_start(self, tmp_path, version):
        path = saved(tmp_path, {"Signal": structure(np.sin(TIMES), label="kNm", factor=1000.0)}, version)
        found = read_recording(path)
        assert (found.names, found.sampling_rate, found.start) == (("Shaft:S",), 2000.0, 0.5)
        np.testing.assert_allclose(found["Shaft:S"].values, 1000 * np.sin(TIMES))
        assert not any(note.startswith("warning") for note in map(str, found.notes))

    def test_several_channels_in_one_structure(self, tmp_path, version):
        values = np.stack([np.sin(TIMES), np.cos(TIMES)], axis=1)
        one = structure(values, label=cells("Nm", "rpm"), name=cells("1:M", "2:n"))
        found = read_recording(saved(tmp_path, {"Signal": one}, version))
        assert found.names == ("1:M", "2:n")
        assert [signal.quantity for signal in found] == ["torque", "velocity"]
        np.testing.assert_allclose(found["2:n"].values, np.cos(TIMES) * np.pi / 30)

    def test_structures_of_two_rates(self, tmp_path, version):
        slow = structure(np.arange(40.0), interval=1 / 200, name="T:oil", label="Nm")
        path = saved(tmp_path, {"Signal_0": structure(TIMES), "Signal_1": slow}, version)
        assert re.search(r"200 Hz .*\(T:oil\); 2000 Hz .*\(Shaft:S\)", message(path))
        assert read_recording(path, sampling_rate=200).names == ("T:oil",)
        assert read_recording(path, sampling_rate=2000, resample=True).names == ("Shaft:S", "T:oil")

    def test_equal_names_are_those_of_the_structures(self, tmp_path, version):
        path = saved(tmp_path, {"C1": structure(TIMES), "C2": structure(TIMES)}, version)
        assert read_recording(path).names == ("C1", "C2")

    def test_a_spectrum_is_left_out(self, tmp_path, version):
        other = structure(np.ones(30), name="spectrum")
        other["x_values"]["quantity"]["label"] = "Hz"
        found = read_recording(saved(tmp_path, {"A": structure(TIMES), "B": other}, version))
        assert found.names == ("Shaft:S",)
        assert "left out, as they are no records over time: spectrum (over Hz)" in found.notes

    def test_a_factor_that_does_not_fit_the_unit_is_said(self, tmp_path, version):
        found = read_recording(saved(tmp_path, {"S": structure(TIMES, label="kNm", factor=9.81)}, version))
        assert any('has the unit "kNm", 1000 in SI, and a factor of 9.81' in note for note in found.notes)

    @pytest.mark.parametrize(
        ("changes", "text"),
        [
            (
                {"increment": None},
                "structure S has y_values, but in x_values no increment; found x_values.",
            ),
            ({"increment": 0.0}, "structure S has an increment of 0 in its x_values, which is no sampling interval"),
            ({"number_of_values": 500.0}, "structure S has 400 values, its number_of_values says 500; export it again"),
        ],
    )
    def test_what_does_not_fit_is_named(self, tmp_path, version, changes, text):
        assert text in message(saved(tmp_path, {"S": structure(TIMES, **changes)}, version))


@pytest.mark.parametrize("version", [7, 7.3])
class TestPulse:
    def content(self, frequency="65536"):
        return {
            "File_Header": {"NumberOfChannels": "2", "SampleFrequency": frequency, "NumberOfSamplesPerChannel": "400"},
            "Channel_1_Header": {"SignalName": "Torque", "Unit": "Nm"},
            "Channel_1_Data": np.sin(TIMES),
            "Channel_2_Header": {"SignalName": "Speed", "Unit": "RPM"},
            "Channel_2_Data": np.cos(TIMES),
        }

    @pytest.mark.parametrize(("frequency", "rate"), [("65536", 65536.0), ("2048,5", 2048.5), ("1.0e3", 1000.0)])
    def test_channels(self, tmp_path, version, frequency, rate):
        found = read_recording(saved(tmp_path, self.content(frequency), version))
        assert (found.names, found.sampling_rate) == (("Torque", "Speed"), rate)
        np.testing.assert_allclose(found["Speed"].values, np.cos(TIMES) * np.pi / 30)

    @pytest.mark.parametrize("names", [("Time", "Time"), ("Time  1 - default sample rate", "Time  2 - slow")])
    def test_channels_of_times_hold_for_those_behind_them(self, tmp_path, version, names):
        content, channels = self.content("2000"), ((TIMES, np.sin(TIMES)), (TIMES + 0.1, np.cos(TIMES)))
        for number, (name, pair) in enumerate(zip(names, channels, strict=True)):
            for place, (values, kind, unit) in enumerate(zip(pair, (name, "TS"[number]), ("s", "Nm"), strict=True), 1):
                content[f"Channel_{2 * number + place}_Header"] = {"SignalName": kind, "Unit": unit}
                content[f"Channel_{2 * number + place}_Data"] = values
        found = read_recording(saved(tmp_path, content, version))
        assert (found.names, found.sampling_rate) == (("T", "S"), 2000.0)
        assert found.start == pytest.approx(0.1)
        np.testing.assert_array_equal(found["T"].values, np.sin(TIMES)[200:])
        np.testing.assert_array_equal(found["S"].values, np.cos(TIMES)[:200])

    def test_no_rate(self, tmp_path, version):
        text = message(saved(tmp_path, self.content("unknown"), version))
        assert 'File_Header has the SampleFrequency "unknown", which is no rate in Hz' in text


@pytest.mark.parametrize("version", [7, 7.3])
def test_unknown_structures_say_what_is_known(tmp_path, version):
    content = {"run": {"meta": {"count": 3.0, "gain": np.ones(4)}, "data": np.ones(50), "more": np.ones(20)}}
    text = message(saved(tmp_path, content, version))
    assert "note: the file has structures with the fields run." in text
    assert "known are those of Testlab (x_values with start_value, increment, number_of_values" in text
