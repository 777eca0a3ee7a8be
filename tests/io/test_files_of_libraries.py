"""Files of other programs in their less usual forms: each is read as its library reads it, or refused by name."""

import re
import shutil

import numpy as np
import pytest

from torsionnet.base.errors import ModelError
from torsionnet.base.notes import warning
from torsionnet.io import read_frequency_response
from torsionnet.signals import read_recording

TIMES = np.arange(4000) / 1000
TORQUE = 10 * np.sin(126 * TIMES) + TIMES
BEGIN = np.datetime64("2024-05-03T10:12:13.000000")


def refusal(path, **options):
    with pytest.raises(ModelError) as caught:
        read_recording(path, **options)
    return str(caught.value)


class TestTdmsSavedAsHdf5:
    """npTDMS keeps the properties of LabVIEW as attributes, dates as texts."""

    @pytest.fixture
    def written(self, tmp_path):
        nptdms = pytest.importorskip("nptdms")
        pytest.importorskip("h5py")

        def write(*channels):
            with nptdms.TdmsWriter(str(tmp_path / "run.tdms")) as writer:
                writer.write_segment([nptdms.ChannelObject(*channel) for channel in channels])
            nptdms.TdmsFile.read(tmp_path / "run.tdms").as_hdf(tmp_path / "run.h5").close()
            return tmp_path / "run.tdms", tmp_path / "run.h5"

        return write

    def wave(self, begun=0, **more):
        return {
            "wf_increment": 0.001,
            "unit_string": "Nm",
            "wf_start_time": BEGIN + np.timedelta64(begun, "ms"),
            **more,
        }

    @pytest.mark.parametrize(
        "later", [{"begun": 250}, {"wf_start_offset": 0.25}, {"begun": 100, "wf_start_offset": 0.15}]
    )
    def test_clocks_are_those_of_the_tdms_file(self, written, later):
        tdms, hdf5 = written(("g", "a", TORQUE, self.wave()), ("g", "b", TORQUE, self.wave(**later)))
        one, other = read_recording(tdms), read_recording(hdf5)
        assert (other.names, other.sampling_rate, other.start) == (("g.a", "g.b"), 1000, pytest.approx(0.25))
        assert one.start == other.start
        for name in "ab":
            assert np.array_equal(one[name].values, other[f"g.{name}"].values)

    def test_an_axis_in_ms_or_degrees(self, written):
        _, hdf5 = written(("g", "a", TORQUE, self.wave(wf_increment=1.0, wf_xunit_string="ms")))
        assert read_recording(hdf5).sampling_rate == 1000
        hdf5.unlink()
        _, hdf5 = written(("g", "a", TORQUE, self.wave(wf_xunit_string="deg")))
        assert re.search(" deg, .*wrong-file", refusal(hdf5))

    def test_time_stamps_beside_a_waveform(self, written):
        stamps = BEGIN + np.timedelta64(250, "ms") + np.arange(4000).astype("m8[ms]")
        even = ("g", "a", TORQUE, self.wave())
        _, hdf5 = written(even, ("h", "Time", stamps), ("h", "b", TORQUE, {"unit_string": "Nm"}))
        found = read_recording(hdf5)
        assert (found.names, found.start, len(found)) == (("g.a", "h.b"), 0.25, 3750)
        assert np.array_equal(found["g.a"].values, TORQUE[250:])


class TestValidity:
    """Limits and fill values of netCDF, as its attributes are written by h5py (NUG, appendix A)."""

    RAW = np.array([-20001, -20000, 0, 20000, 20001, 30000, -32768, -32767], "i2")

    def read(self, tmp_path, raw, file=(), **attributes):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "run.h5", "w") as content:
            content.create_dataset("T", data=raw).attrs.update({"units": "N*m", "fs": 1000.0, **attributes})
            content.attrs.update(dict(file))
        return read_recording(tmp_path / "run.h5")["T"]

    @pytest.mark.parametrize(("attributes", "missing", "said"), [
        ({"valid_range": np.array([-20000, 20000], "i2")}, [0, 4, 5, 6, 7], "below -20000 or above 20000"),
        ({"valid_min": np.int16(0)}, [0, 1, 6, 7], "below 0"), ({"valid_max": np.int16(20000)}, [4, 5], "above 20000"),
        ({"valid_range": np.array([-20.0, 20.0])}, [0, 4, 5, 6, 7], "below -20 or above 20"),
        ({"missing_value": np.array([30000, -32768], "i2")}, [5, 6], "of 30000, -32768"),
        ({"_FillValue": np.int16(-32768), "valid_max": np.int16(20000)}, [4, 5, 6], "of -32768 or above 20000"),
    ])  # fmt: skip
    def test_values_outside_are_missing(self, tmp_path, attributes, missing, said):
        """Limits hold for the packed numbers, those of a wider type for the values."""
        found = self.read(tmp_path, self.RAW, scale_factor=0.001, **attributes)
        assert np.flatnonzero(np.isnan(found.values)).tolist() == missing
        assert np.nanmax(np.abs(found.values - self.RAW / 1000)) < 1e-12
        assert f"values {said} are missing, as NaN" in found.notes

    def test_unsigned_numbers(self, tmp_path):
        found = self.read(tmp_path, self.RAW, _Unsigned="true", _FillValue=np.int16(-32768), scale_factor=0.5)
        assert np.array_equal(
            found.values, np.where(self.RAW == -32768, np.nan, self.RAW.view("u2") / 2), equal_nan=True
        )

    def test_what_netcdf_never_wrote_is_missing(self, tmp_path):
        own = {"_NCProperties": "version=2,netcdf=4.9.2"}
        assert np.flatnonzero(np.isnan(self.read(tmp_path, self.RAW, own).values)).tolist() == [7]
        assert not np.isnan(self.read(tmp_path, self.RAW).values).any()


def test_channels_by_samples_with_scales_of_both(tmp_path):
    h5py = pytest.importorskip("h5py")
    for turned in (False, True):
        with h5py.File(tmp_path / "run.h5", "w") as file:
            file["time"], file["ch"] = TIMES, np.arange(2)
            values = np.column_stack([TORQUE, -TORQUE])
            file["T"] = values.T if turned else values
            for at, name in enumerate(["ch", "time"] if turned else ["time", "ch"]):
                file[name].make_scale(name)
                file["T"].dims[at].attach_scale(file[name])
        found = read_recording(tmp_path / "run.h5")
        assert (found.names, found.sampling_rate) == (("T_1", "T_2"), 1000)
        assert np.array_equal(found["T_2"].values, -TORQUE)


@pytest.mark.parametrize("version", ["3.30", "4.10"])
def test_mdf_with_an_ending_of_text(tmp_path, version):
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version=version) as file:
        file.append([asammdf.Signal(TORQUE, TIMES + 0.5, "Nm", "T")])
        shutil.copy(file.save(tmp_path / "run.mf4", overwrite=True), tmp_path / "run.dat")
    found = read_recording(tmp_path / "run.dat")
    assert (found.names, found.sampling_rate, found.start) == (("T",), 1000, 0.5)
    assert np.array_equal(found["T"].values, TORQUE)


class TestResponsesInMat73:
    LINES = np.arange(1, 101) * 0.5
    VALUES = 1 / (1000 - 0.1 * (2 * np.pi * LINES) ** 2 + 0.8j * np.pi * LINES)

    def write(self, path, **content):
        """As MATLAB writes: dimensions the other way round, complex numbers in two fields, the class of each."""
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, values in content.items():
                if isinstance(values, str):
                    item = file.create_dataset(name, data=np.array([[ord(letter)] for letter in values], "u2"))
                    item.attrs["MATLAB_class"] = np.bytes_("char")
                    continue
                turned = np.asarray(values).T
                if turned.dtype.kind == "c":
                    turned = np.rec.fromarrays([turned.real, turned.imag], names="real,imag")
                file.create_dataset(name, data=turned).attrs["MATLAB_class"] = np.bytes_("double")
        return path

    def test_arrays_of_any_origin(self, tmp_path):
        for values in (self.VALUES[:, None], self.VALUES[None], np.column_stack([self.VALUES, 2 * self.VALUES])):
            path = self.write(tmp_path / "h.mat", Freq=self.LINES[:, None], H=values)
            found = read_frequency_response(path)
            assert np.array_equal(found.frequencies, self.LINES)
            assert np.array_equal(found.values[:, 0, 0], self.VALUES)
        assert re.search("Freq, H .*unreadable-file", refusal(path))

    def test_one_that_was_written_here_and_saved_again(self, tmp_path):
        from scipy.io import loadmat

        from torsionnet.io import write_frequency_response

        response = read_frequency_response(
            self.write(tmp_path / "h.mat", Freq=self.LINES[:, None], H=self.VALUES[:, None])
        )
        write_frequency_response(response, tmp_path / "own.mat")
        kept = {
            name: one for name, one in loadmat(tmp_path / "own.mat").items() if name[0] != "_" and one.dtype != object
        }
        texts = {name: str(one[0]) if one.dtype.kind == "U" else one for name, one in kept.items() if one.size}
        again = read_frequency_response(self.write(tmp_path / "again.mat", **texts))
        assert np.array_equal(again.values, response.values)
        assert (again.outputs, again.inputs) == (response.outputs, response.inputs)


class TestTextsWithSeveralClocks:
    def stamp(self, at, late=0):
        return str(BEGIN.astype("M8[ms]") + np.timedelta64(at + late, "ms"))

    @pytest.mark.parametrize("late", [250, -250])
    def test_dates_in_two_columns(self, tmp_path, late):
        rows = [
            f"{self.stamp(at)},{value!r},{self.stamp(at, late)},{value!r}" for at, value in enumerate(TORQUE.tolist())
        ]
        (tmp_path / "r.csv").write_text("\n".join(["Time,T [Nm],Time 2,M [Nm]", *rows, ""]))
        found = read_recording(tmp_path / "r.csv")
        assert (len(found), found.start) == (3750, max(0, late) / 1000)
        first, second = (TORQUE[at : at + 3750] for at in (max(0, late), max(0, -late)))
        assert np.array_equal(found["T"].values, first)
        assert np.array_equal(found["M"].values, second)
        assert '"Time", "Time 2" were taken for the time stamps of the columns behind each' in found.notes

    def test_equal_dates_are_one_clock(self, tmp_path):
        rows = [f"{self.stamp(at)},{at},{self.stamp(at)},{at}" for at in range(50)]
        (tmp_path / "r.csv").write_text("\n".join(["Time,T [Nm],Received,M [Nm]", *rows, ""]))
        found = read_recording(tmp_path / "r.csv")
        assert (found.names, len(found)) == (("T", "M"), 50)
        assert '"Received" holds dates and times of day, and was left out' in found.notes

    def test_segments_of_an_oscilloscope(self, tmp_path):
        """Times since the first trigger keep the gaps between segments; a second heading or start is named."""
        rows = [[f"{at / 1000 + begun:.9E},{at % 7}" for at in range(100)] for begun in (0.0, 2.7, 0.0)]
        heading = ["x-axis,1", "second,Volt"]
        path = tmp_path / "r.csv"
        path.write_text("\n".join(["100", *heading, *rows[0], *rows[1], ""]))
        assert np.diff(read_recording(path).times).max() == pytest.approx(2.7 - 0.099)
        path.write_text("\n".join([*heading, *rows[0], *rows[2], ""]))
        assert "begins again, save each" in refusal(path)
        path.write_text("\n".join([*heading, *rows[0], *heading, *rows[1], ""]))
        assert '"x-axis" is the' in refusal(path)


def test_two_given_clocks_of_one_file(tmp_path):
    np.savez(tmp_path / "r.npz", t1=TIMES, T=TORQUE, t2=TIMES + 0.25, M=TORQUE)
    units = {"t1": "s", "t2": "s"}
    assert "t1, t2 were given" in refusal(tmp_path / "r.npz", units=units)
    found = read_recording(tmp_path / "r.npz", units={"t1": "s"})
    assert warning("t2 holds other times than t1, which was taken for all channels") in found.notes
