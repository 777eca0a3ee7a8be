"""Dimension scales and channels without a clock in HDF5 files: no channel is put on the clock of another in silence."""

import re

import numpy as np
import pytest
from support.command_line import run

from torsionnet.base.errors import ModelError
from torsionnet.base.notes import warning
from torsionnet.signals import read_recording

TIMES = np.arange(4000) / 1000
SPEED, TORQUE = 2 * np.cos(44 * TIMES), 10 * np.sin(126 * TIMES)


def hdf5():
    """The package that writes the files, loaded when the first of them is written."""
    return pytest.importorskip("h5py")


@pytest.fixture
def written(tmp_path):
    def write(content, scales=()):
        """Datasets by name, with a unit behind a blank in it, of which some are scales of others."""
        path = tmp_path / "run.h5"
        with hdf5().File(path, "w") as file:
            for label, values in content.items():
                name, _, unit = label.partition(" ")
                file[name] = values
                file[name].attrs["units"] = unit
            for name, scale in dict(scales).items():
                file[scale].make_scale(scale)
                file[name].dims[0].attach_scale(file[scale])
        return path

    return write


@pytest.fixture
def two_scales(written):
    """T over x1 and w over x2, both in ms and named as nothing, of which w begins 0.25 s later."""
    content = {"x1": 1000 * TIMES, "x2": 1000 * TIMES + 250, "T N*m": TORQUE, "w rad/s": SPEED}
    return written(content, {"T": "x1", "w": "x2"})


def refusal(path, **options):
    with pytest.raises(ModelError) as caught:
        read_recording(path, **options)
    return str(caught.value)


class TestScalesOfUnknownKind:
    def test_a_unit_makes_one_the_clock_of_its_own_channels(self, two_scales):
        found = read_recording(two_scales, names=["T"], units={"x1": "ms"})
        assert (found.sampling_rate, found.start, len(found)) == (1000, 0, 4000)
        refused = refusal(two_scales, units={"x1": "ms"})
        assert re.search(r'w \(over x2\).*T \(1000 Hz.*units=.*"x2": "s".*sampling_rate=1000 .*unlike-results', refused)
        assert re.search(r"T \(over x1\).*, w.*unlike-results", refusal(two_scales, units={"x2": "ms"}))

    def test_units_of_both(self, two_scales):
        found = read_recording(two_scales, units={"x1": "ms", "x2": "ms"})
        assert (found.names, found.sampling_rate, found.start) == (("T", "w"), 1000, 0.25)
        assert np.array_equal(found["T"].values, TORQUE[250:])
        assert np.array_equal(found["w"].values, SPEED[:3750])

    def test_one_in_degrees(self, two_scales):
        found = read_recording(two_scales, units={"x1": "deg", "x2": "ms"})
        assert (found.names, found.start) == (("w",), 0.25)
        assert "left out, as they are no records over time: T (over deg)" in found.notes

    def test_without_units_they_are_asked_for(self, two_scales):
        assert re.search('"x1": "s".* sampling_rate= .*missing-entry', refusal(two_scales))
        said = warning("channels over x1, x2 were taken to begin together, at one rate")
        assert said in read_recording(two_scales, sampling_rate=1000).notes
        asked = run("estimate", two_scales, "--input", "T", "--output", "w", code=1).stderr
        assert re.search("--unit x2=s .*--sampling-rate.*missing-entry", asked)

    def test_beside_time_stamps(self, written):
        """A dataset named time is no clock of what goes over another scale; it is where both go over one."""
        content = {"time s": TIMES, "T N*m": TORQUE, "w rad/s": SPEED, "n": np.arange(4000.0)}
        path = written(content, {"T": "n"})
        assert re.search(r"T \(over n\).*, w \(1000 .*unlike-results", refusal(path))
        for scales in ({"T": "n", "time": "n"}, {"T": "n", "time": "n", "w": "n"}):
            found = read_recording(written(content, scales))
            assert {"T", "w"} <= {*found.names}
            assert found.sampling_rate == 1000

    def test_dimensions_of_netcdf_without_values(self, written):
        """They are no channels, and tell what was sampled together."""
        content = {"time s": TIMES, "T N*m": TORQUE, "w rad/s": SPEED, "n": np.zeros(4000), "m": np.zeros(4000)}

        def named(path):
            with hdf5().File(path, "a") as file:
                for name in "nm":
                    file[name].attrs["NAME"] = np.bytes_("This is a netCDF dimension but not a netCDF variable.  4000")
            return path

        found = read_recording(named(written(content, {"time": "n", "T": "n", "w": "n"})))
        assert (found.names, found.sampling_rate) == (("T", "w"), 1000)
        path = named(written(content, {"time": "n", "T": "n", "w": "m"}))
        assert re.search(r"w \(over m\).*, T \(1000 .*unlike-results", refusal(path))


class TestChannelsWithoutAClock:
    def test_times_of_one_group_are_not_those_of_another(self, written):
        path = written({"a/time s": TIMES + 0.25, "a/T N*m": TORQUE, "b/w rad/s": SPEED})
        assert re.search(r"b\.w .*, a\.T .*0\.25 s.*unlike-results", refusal(path))
        found = read_recording(path, sampling_rate=1000)
        assert "b.w: no clock in the file, taken to be sampled with the others" in found.notes
        assert (found.start, len(found)) == (0.25, 4000)
        assert np.array_equal(found["b.w"].values, SPEED)

    @pytest.mark.parametrize("around", ["time s", "axes/time s", "run/time s"])
    def test_times_around_groups_or_by_themselves_hold_for_all(self, written, around):
        found = read_recording(written({around: TIMES, "run/a/T N*m": TORQUE, "run/b/w rad/s": SPEED}))
        assert (found.names, found.sampling_rate) == (("run.a.T", "run.b.w"), 1000)

    def test_times_named_after_a_channel_are_those_of_no_other(self, written):
        path = written({"t_T s": TIMES, "T N*m": TORQUE, "w rad/s": SPEED})
        assert re.search(r"w .*, T \(1000 .*unlike-results", refusal(path))

    def test_a_rate_of_a_neighbour_brings_its_start(self, written):
        path = written({"T N*m": TORQUE, "w rad/s": SPEED})
        with hdf5().File(path, "a") as file:
            file["T"].attrs.update({"fs": 1000.0, "t0": 0.25})
        found = read_recording(path)
        assert (found.start, len(found)) == (0.25, 4000)

    def test_neighbours_that_begin_at_several_times_leave_it_open(self, written):
        path = written({"T N*m": TORQUE, "T2 N*m": TORQUE, "w rad/s": SPEED})
        with hdf5().File(path, "a") as file:
            file["T"].attrs.update({"fs": 1000.0, "t0": 0.25})
            file["T2"].attrs.update({"fs": 1000.0, "t0": 0.5})
        assert "unlike-results" in refusal(path, sampling_rate=1000)
