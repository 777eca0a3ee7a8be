"""Binary files of other programs: whatever is in them, a result or one error with the file's name, and no crash."""

import io
import os
import re
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from support import campaigns
from support.foreign_files import (
    CHILD_ENDINGS,
    COUNT,
    EXTRAS,
    damaged,
    mat_file,
    mat_variable,
    matlab_73,
    record,
    written,
)

import torsionnet as tn
from torsionnet.app.cli.app import app
from torsionnet.base.errors import ModelError
from torsionnet.signals import iter_blocks, read_recording, write_recording
from torsionnet.signals.foreign import ForeignFileError, process
from torsionnet.signals.foreign import content as resource_limits
from torsionnet.signals.foreign.__main__ import error_line
from torsionnet.signals.foreign.uff_content import check_end


def needs(ending):
    pytest.importorskip(EXTRAS[ending])


def message(path, **options):
    with pytest.raises(ModelError) as caught:
        read_recording(path, **options)
    text = str(caught.value)
    assert path.name in text
    assert text.isprintable() or "\n" in text
    return text


@pytest.fixture
def library(tmp_path, monkeypatch):
    """A library that does as it is told when it opens a file, in place of h5py."""

    def replaced(what):
        folder = tmp_path / "library"
        folder.mkdir(exist_ok=True)
        (folder / "h5py.py").write_text(
            f"import ctypes, os, sys, time\nclass File:\n    def __init__(self, path, mode):\n{textwrap.indent(textwrap.dedent(what), ' ' * 8)}\n"
        )
        process.end_all()
        monkeypatch.syspath_prepend(str(folder))
        monkeypatch.setattr("torsionnet.signals.formats.extras.require_extra", lambda _: None)
        path = tmp_path / "plant.h5"
        path.write_bytes(b"anything")
        return path

    yield replaced
    process.end_all()


class TestCrashes:
    @pytest.mark.few(2)
    @pytest.mark.parametrize(
        ("what", "text"),
        [
            ("ctypes.string_at(0)", "crashed (SIGSEGV)"),
            ("os.abort()", "crashed (SIGABRT)"),
            ("os._exit(3)", "ended (exit code 3)"),
            ("raise MemoryError", "more memory than a file of its size may take"),
            ("raise KeyError(17)", "it is damaged (KeyError: 17)"),
            ("raise ValueError('bad \\x1b[31m\\n bytes \\x00 here')", "bad ?[31m"),
            ("raise SystemExit", "ended (exit code 0)"),
        ],
    )
    @pytest.mark.skipif(os.name != "posix", reason="signals have other names")
    def test_becomes_a_located_error(self, library, what, text):
        assert text in message(library(what))

    def test_what_it_prints_goes_nowhere(self, library, capfd):
        path = library(
            "print('out'); print('err', file=sys.stderr); os.write(1, b'raw'); os.write(2, b'raw'); raise OSError('no such thing')"
        )
        assert "no such thing" in message(path)
        assert capfd.readouterr() == ("", "")

    @pytest.mark.slow
    @pytest.mark.skipif(sys.platform != "linux", reason="limits of time and memory are those of Linux")
    @pytest.mark.parametrize(
        ("what", "text"),
        [
            ("while True: pass", "did not come to an end"),
            ("import numpy; x = [numpy.empty(10**8, 'u1') for _ in range(99)]", "more memory"),
        ],
    )
    def test_ends_what_has_no_end(self, library, what, text):
        assert text in message(library(what))

    def test_a_file_is_not_blamed_for_the_one_before(self, library):
        """The second file of a process that the first has left damaged is read once more, in a fresh process."""
        path = library(
            """
            if str(path).endswith('first.h5'):
                sys.modules['spoilt'] = True
            elif 'spoilt' in sys.modules:
                os.abort()
            else:
                raise ValueError('read by itself')
            """
        )
        first = path.with_name("first.h5")
        first.write_bytes(b"x")
        with process.borrow_process() as running:
            running.is_used = True
            with pytest.raises(process.ForeignFileError):
                running.ask({"open": str(first), "form": "hdf5"})
            running.is_responsive = True  # as if the library had noticed nothing
        assert "read by itself" in message(path)

    @pytest.mark.parametrize("ending", [".h5", ".mat"])
    def test_command_line_says_it_with_exit_code_1(self, tmp_path, ending):
        needs(ending)
        path = written(tmp_path, ending)
        path.write_bytes(path.read_bytes()[:300])
        result = CliRunner().invoke(
            app, ["spectrogram", str(path), "--channel", "T_T", "--plot", str(tmp_path / "p.png")]
        )
        assert result.exit_code == 1
        assert "Traceback" not in result.output
        assert path.name in result.output


class TestProcess:
    @pytest.mark.slow
    def test_one_for_several_files(self, tmp_path, monkeypatch):
        needs(".h5")
        paths = [written(tmp_path / str(number), ".h5") for number in range(3) if not (tmp_path / str(number)).mkdir()]
        process.end_all()
        started = []
        begin = process.ReaderProcess.__init__
        monkeypatch.setattr(process.ReaderProcess, "__init__", lambda self: (started.append(1), begin(self))[1])
        for path in paths:
            read_recording(path)
        assert len(started) == 1

    def test_two_files_at_once(self, tmp_path):
        needs(".h5")
        path = written(tmp_path, ".h5")
        for one, other in zip(iter_blocks(path, 0.05), iter_blocks(path, 0.05), strict=True):
            np.testing.assert_array_equal(one["T_T"].values, other["T_T"].values)

    def test_leaves_no_file_behind(self, tmp_path, monkeypatch):
        needs(".h5")
        path = written(tmp_path, ".h5")
        process.end_all()
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
        (tmp_path / "temporary").mkdir()
        read_recording(path)
        next(iter_blocks(path, 0.05))
        process.end_all()
        assert list((tmp_path / "temporary").iterdir()) == []

    @pytest.mark.slow
    def test_the_working_folder_hides_no_library(self, tmp_path):
        needs(".h5")
        path = written(tmp_path, ".h5")
        (tmp_path / "h5py.py").write_text("raise SystemExit('taken from the working folder')")
        program = "import sys; sys.path[:] = [p for p in sys.path if p]; import torsionnet as tn; print(len(tn.signals.read_recording(sys.argv[1])))"
        environment = os.environ | {"PYTHONPATH": str(process.PACKAGE.parent)}
        ran = subprocess.run(
            [sys.executable, "-c", program, str(path)],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert ran.stdout.strip() == str(COUNT), ran.stderr

    @pytest.mark.slow
    def test_blocks_are_those_of_the_whole(self, tmp_path):
        for ending in CHILD_ENDINGS:
            needs(ending)
            path = written(tmp_path, ending)
            blocks = [block["T_T"].values for block in iter_blocks(path, 0.07)]
            assert [len(block) for block in blocks] == [70, 70, 60]
            np.testing.assert_array_equal(np.concatenate(blocks), record()["T_T"].values)

    def test_words_of_errors_are_short_and_plain(self):
        assert error_line(ValueError("x " * 1000)).endswith("...")
        assert error_line(ValueError("")) == "it is damaged (ValueError)"


class TestDamagedFiles:
    """Bytes changed or cut off: a result or one error, at once."""

    def assert_well_behaved(self, path, content):
        path.write_bytes(content)
        text = ""
        try:
            read_recording(path)
        except ModelError as error:
            text = str(error)
        assert not text or path.name in text
        assert "Traceback" not in text

    @pytest.mark.parametrize("ending", CHILD_ENDINGS)
    def test_some(self, tmp_path, ending):
        needs(ending)
        raw = written(tmp_path, ending).read_bytes()
        for seed in range(6):
            self.assert_well_behaved(tmp_path / f"damaged{ending}", damaged(raw, seed))

    @pytest.mark.slow
    @pytest.mark.parametrize("block", campaigns.by_day(range(4), 0))
    def test_hdf5_and_mat(self, tmp_path, block):
        pytest.importorskip("h5py")
        sources = [written(tmp_path, ".h5"), written(tmp_path, ".mat"), matlab_73(tmp_path / "new.mat")]
        for seed in range(20 * block, 20 * (block + 1)):
            source = sources[seed % 3]
            self.assert_well_behaved(tmp_path / f"damaged{source.suffix}", damaged(source.read_bytes(), f"more {seed}"))

    @pytest.mark.parametrize("ending", [".npz", *CHILD_ENDINGS])
    def test_cut_anywhere(self, tmp_path, ending):
        needs(ending)
        raw = written(tmp_path, ending).read_bytes()
        for length in np.linspace(1, len(raw) - 1, 4, dtype=int):
            self.assert_well_behaved(tmp_path / f"cut{ending}", raw[:length])


class TestOtherFiles:
    """An HDF5 file may name other files, whose bytes would be taken for samples."""

    def test_external_storage(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        secret = tmp_path / "secret.txt"
        secret.write_bytes(b"x" * 800)
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file.create_dataset("T_T", shape=(100,), dtype="f8", external=[(str(secret), 0, 800)])
        assert f'in another file, "{secret}"' in message(tmp_path / "r.h5")

    @pytest.mark.parametrize("ending", [".h5", ".mat"])
    def test_external_link(self, tmp_path, ending):
        h5py = pytest.importorskip("h5py")
        written(tmp_path, ".h5")
        with h5py.File(tmp_path / f"r{ending}", "w") as file:
            file["group/M"] = h5py.ExternalLink("record.h5", "/T_T")
        assert '"group/M" keeps' in message(tmp_path / f"r{ending}")

    def test_virtual_dataset(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        written(tmp_path, ".h5")
        layout = h5py.VirtualLayout(shape=(COUNT,), dtype="f8")
        layout[:] = h5py.VirtualSource("record.h5", "T_T", shape=(COUNT,))
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file.create_virtual_dataset("M", layout)
        assert '"M" keeps' in message(tmp_path / "r.h5")

    def test_virtual_dataset_within_the_file(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        layout = h5py.VirtualLayout(shape=(4,), dtype="f8")
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file["x"] = np.arange(4.0)
            layout[:] = h5py.VirtualSource(".", "x", shape=(4,))
            file.create_virtual_dataset("M", layout)
            file.attrs["fs"] = 10.0
        np.testing.assert_array_equal(read_recording(tmp_path / "r.h5")["M"].values, np.arange(4.0))


class TestClaims:
    """What a file says that it holds is compared with what is there before anything is unpacked."""

    def npz(self, path, header=None, content=b"", size=None, **arrays):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, values in arrays.items():
                buffer = io.BytesIO()
                np.save(buffer, values, allow_pickle=True)
                archive.writestr(f"{name}.npy", buffer.getvalue())
            if header is not None:
                buffer = io.BytesIO()
                np.lib.format.write_array_header_1_0(buffer, header)
                archive.writestr("x.npy", buffer.getvalue() + content)
        if size is not None:  # of the directory at the end, which zip programs believe
            raw = bytearray(path.read_bytes())
            at = raw.rfind(b"PK\x01\x02")
            raw[at + 24 : at + 28] = size.to_bytes(4, "little")
            path.write_bytes(raw)
        return path

    def test_npz_header(self, tmp_path):
        header = {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
        text = message(self.npz(tmp_path / "r.npz", header, b"\0" * 80))
        assert re.search("x .* 8000000000128 bytes, .* 208; ", text)

    @pytest.mark.parametrize("shape", [(-1,), (2**40, 2**40), (10**6, 10**6)])
    def test_npz_shapes(self, tmp_path, shape):
        message(self.npz(tmp_path / "r.npz", {"descr": "<f8", "fortran_order": False, "shape": shape}))

    def test_npz_directory(self, tmp_path):
        message(self.npz(tmp_path / "r.npz", x=np.zeros(10), size=2**31))

    @pytest.mark.slow
    def test_npz_bomb(self, tmp_path):
        path = self.npz(tmp_path / "r.npz", x=np.zeros(2**25 + 1))
        assert re.search("268.436 MB .* 256 MB", message(path))

    @pytest.mark.parametrize("read", [read_recording, tn.io.read_frequency_response])
    def test_npz_pickle(self, tmp_path, read):
        path = self.npz(tmp_path / "r.npz", x=np.array([{"a": 1}], dtype=object), y=np.zeros(3))
        with pytest.raises(ModelError, match="unreadable-file"):
            read(path)

    @pytest.mark.parametrize("compressed", [False, True])
    @pytest.mark.parametrize(
        ("dimensions", "kind"), [((2**30, 1), 6), ((10**5, 10**5), 6), ((10**8, 1), 1), ((2**31 - 1, 1), 2)]
    )
    def test_mat_dimensions(self, tmp_path, dimensions, kind, compressed):
        path = mat_file(tmp_path / "r.mat", mat_variable("x", dimensions, kind), compressed=compressed)
        assert "variable 1 says" in message(path)

    def test_mat_length(self, tmp_path):
        path = mat_file(tmp_path / "r.mat", mat_variable("x", (1, 1)), mat_variable("y", (1, 1), length=10**9))
        assert "variable 2 says" in message(path)

    @pytest.mark.slow
    def test_mat_bomb(self, tmp_path):
        from scipy.io import savemat

        path = tmp_path / "r.mat"
        savemat(path, {"x": np.zeros(2**25 + 1)}, do_compression=True)
        text = message(path)
        assert "would take 268" in text
        assert "may take 256 MB" in text

    def test_mat_that_is_sound(self, tmp_path):
        from scipy.io import savemat

        for compressed in (False, True):
            content = {
                "fs": 10.0,
                "c": np.array(["a", 1], dtype=object),
                "s": {"x": np.arange(5.0)},
                "text": "words",
                "empty": np.zeros((0, 3)),
            }
            savemat(tmp_path / "r.mat", content, do_compression=compressed)
            np.testing.assert_array_equal(read_recording(tmp_path / "r.mat")["s.x"].values, np.arange(5.0))

    def test_mat_4(self, tmp_path):
        from scipy.io import savemat

        path = tmp_path / "r.mat"
        savemat(path, {"x": np.arange(50.0)}, format="4")
        np.testing.assert_array_equal(read_recording(path, sampling_rate=10)["x"].values, np.arange(50.0))
        path.write_bytes(path.read_bytes()[:-8])
        assert "variable 1 says" in message(path, sampling_rate=10)

    def test_hdf5_of_samples_never_written(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file.create_dataset("x", shape=(10**10,), dtype="f8", chunks=(10**6,))
        assert " 80000 MB " in message(tmp_path / "r.h5", sampling_rate=10)

    @pytest.mark.slow
    def test_parquet_of_one_value(self, tmp_path):
        pytest.importorskip("pyarrow")
        import pyarrow as pa
        from pyarrow import parquet

        parquet.write_table(pa.table({"x": np.zeros(40_000_000)}), tmp_path / "r.parquet")
        assert " 320 MB " in message(tmp_path / "r.parquet", sampling_rate=10)

    def test_a_large_file_may_take_more(self, tmp_path):
        (tmp_path / "large").write_bytes(b"\0" * 10_000_000)
        assert resource_limits.largest_unpacked(tmp_path / "large") == 10**9


@pytest.mark.few(1)
@pytest.mark.skipif(sys.platform != "linux", reason="a limit to the size of files is one of POSIX")
@pytest.mark.parametrize("ending", [".npz", ".csv", *CHILD_ENDINGS])
def test_a_full_disk_leaves_the_old_file(tmp_path, ending):
    """A limit to the size of files fails writes as a full disk does; HDF5 used to crash on it."""
    if ending in EXTRAS:
        needs(ending)
    path = tmp_path / f"record{ending}"
    path.write_bytes(b"the old one")
    program = f"""
        import resource, sys
        sys.path.insert(0, {str(Path(__file__).parents[1])!r})
        from support.foreign_files import record
        from torsionnet.signals import write_recording
        found = record(20_000)
        resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
        try:
            write_recording(found, {str(path)!r})
        except OSError:
            print("refused")
        """
    ran = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": str(process.PACKAGE.parent)},
    )
    assert (ran.returncode, ran.stdout) == (0, "refused\n"), ran.stderr
    assert path.read_bytes() == b"the old one"
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


class TestEarlyEnds:
    def test_universal_file_cut_anywhere(self, tmp_path):
        """Whatever is left says that it ends early; whole channels before the cut are named with what should follow."""
        needs(".uff")
        raw = written(tmp_path, ".uff", 20).read_bytes()
        path = tmp_path / "cut.uff"
        path.write_bytes(raw[:-200])
        assert '"phi" is not whole' in message(path)
        for length in range(1, len(raw) - 2):
            with pytest.raises(ForeignFileError, match="ends early"):
                check_end(raw[:length])

    def test_universal_file_cut_between_channels(self, tmp_path):
        needs(".uff")
        raw = written(tmp_path, ".uff", 20).read_bytes()
        path = tmp_path / "cut.uff"
        path.write_bytes(raw[: raw.rindex(b"    -1\n    58b")])
        assert '"T_T", and 1 more' in message(path)

    def test_response_cut_anywhere(self, tmp_path):
        needs(".uff")
        response = tn.load("dmf_rig").frequency_response(["theta_1", "T_T"], "T_M", [1.0, 2.0, 5.0])
        tn.io.write_frequency_response(response, tmp_path / "r.uff")
        raw = (tmp_path / "r.uff").read_bytes()
        for length in range(raw.index(b"    -1\n    58b") + 6, len(raw) - 1):
            with pytest.raises(ForeignFileError, match="ends early"):
                check_end(raw[:length])
        (tmp_path / "cut.uff").write_bytes(raw[: raw.index(b"    -1\n    58b")])
        with pytest.raises(ModelError, match="wrong-file"):
            tn.io.read_frequency_response(tmp_path / "cut.uff")

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            (
                "t [s],M [Nm],n [rpm]\n0,1.25,3\n1,1.50,3\n2,1.7",
                "4:1: error: the file ends early: the last row lacks n, and its M may be cut",
            ),
            ("t [s],M [Nm],n [rpm]\n0,1.25,3\n1,1.50,3\n2", "the last row lacks M, n, and its t may be cut"),
            (
                "t [s],M [Nm]\n0,1.25\n1,1.50\n2,1.75\n3,1.",
                "5:1: error: the file ends early: the last number of M is cut",
            ),
            ("t [s],M [Nm]\n0,1.25\n1,1.50\n2,1.75\n3,1.5", "the last number of M is cut"),
            ("t [s],M [Nm]\n0,1\n1,1.5\n2,-", "the last number of M is cut"),
            ("t [s],M [Nm]\n0,1.25e-03\n1,1.50e-03\n2,1.75e-03\n3,1.75e-0", "the last number of M is cut"),
            ("t [s],M [Nm]\n0,1.25\n1,1.50\n2,1.75\n3,", "the last number of M is cut"),
            ("t [s];M [Nm]\n0;1,25\n1;1,50\n2;1,75\n3;1,2", "the last number of M is cut"),
        ],
    )
    def test_text(self, tmp_path, text, expected):
        path = tmp_path / "r.csv"
        path.write_text(text)
        assert expected in message(path)

    @pytest.mark.parametrize(
        "text",
        [
            "t [s],M [Nm]\n0,1.25\n1,1.5\n2,1",
            "t [s],M [Nm]\n0,1.25\n1,1.50\n2,1.75",
            "t [s],M [Nm]\n0,1\n1,2\n2,3",
            "t [s],M [Nm]\n0,1\n1,2\n2,4",
        ],
    )
    def test_text_that_may_be_whole(self, tmp_path, text):
        path = tmp_path / "r.csv"
        path.write_text(text)
        assert len(read_recording(path)) == 3

    def test_text_of_this_package(self, tmp_path):
        """It ends every line, so that any cut within the last one shows."""
        raw = written(tmp_path, ".csv", 5).read_text()
        path = tmp_path / "cut.csv"
        for length in range(1, len(raw.splitlines()[-1]) + 1):
            path.write_text(raw[:-length])
            assert "ends early" in message(path)

    def test_text_of_many_rows(self, tmp_path):
        path = tmp_path / "r.csv"
        path.write_text("t [s],M [Nm]\n" + "".join(f"{row},1.50\n" for row in range(20_000)) + "20000,1.5")
        assert re.search("20002:1: .*truncated-file", message(path))

    @pytest.mark.parametrize("length", [1, 4, 30])
    def test_text_of_a_response(self, tmp_path, length):
        response = tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1.0, 2.0, 5.0])
        tn.io.write_frequency_response(response, tmp_path / "r.csv")
        path = tmp_path / "cut.csv"
        path.write_text((tmp_path / "r.csv").read_text()[:-length])
        with pytest.raises(ModelError, match="the file ends early"):
            tn.io.read_frequency_response(path)


class TestTimes:
    @pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
    @pytest.mark.parametrize("kind", ["timestamp", "duration"])
    def test_parquet(self, tmp_path, kind, unit):
        pa = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        ticks = {"s": 1, "ms": 1000, "us": 10**6, "ns": 10**9}[unit]
        stamps = 1_700_000_000 * ticks + np.arange(10, dtype="i8") * max(ticks // 100, 1)
        table = pa.table({"when": pa.array(stamps, type=getattr(pa, kind)(unit)), "M [Nm]": np.arange(10.0)})
        parquet.write_table(table, tmp_path / "r.parquet")
        found = read_recording(tmp_path / "r.parquet")
        assert found.sampling_rate == (100.0 if unit != "s" else 1.0)
        assert found.start == 0.0
        assert found.names == ("M",)
        assert any(note.startswith("when counts from ") for note in found.notes)

    def test_parquet_with_a_gap_in_its_times(self, tmp_path):
        pa = pytest.importorskip("pyarrow")
        from pyarrow import parquet

        stamps = pa.array([0, None, 2000], type=pa.timestamp("ms"))
        parquet.write_table(pa.table({"when": stamps, "M [Nm]": np.arange(3.0)}), tmp_path / "r.parquet")
        assert "sample 2 has" in message(tmp_path / "r.parquet")

    @pytest.mark.parametrize("shape", [(-1,), (-1, 1), (1, -1)])
    @pytest.mark.parametrize("key", ["time", "t", "Time"])
    def test_mat_structure(self, tmp_path, shape, key):
        from scipy.io import savemat

        times = np.arange(20) / 50
        savemat(tmp_path / "r.mat", {"d": {key: times.reshape(shape), "M": np.arange(20.0).reshape(shape)}})
        found = read_recording(tmp_path / "r.mat", quantities={"d.M": "torque"})
        assert found.sampling_rate == pytest.approx(50)
        np.testing.assert_array_equal(found["d.M"].values, np.arange(20.0))

    def test_mat_structure_with_time_of_simulink(self, tmp_path):
        from scipy.io import savemat

        signals = np.array([(np.arange(4.0),), (np.arange(4.0)[::-1],)], dtype=[("values", object)])
        savemat(tmp_path / "r.mat", {"out": {"time": np.arange(4.0)[:, None] / 10, "signals": signals}})
        found = read_recording(tmp_path / "r.mat")
        assert found.sampling_rate == pytest.approx(10)
        assert found.names == ("out.signals1.values", "out.signals2.values")

    def test_mat_structure_within_a_structure(self, tmp_path):
        from scipy.io import savemat

        savemat(tmp_path / "r.mat", {"test": {"d": {"time": np.arange(5.0), "M": np.arange(5.0)}}})
        assert read_recording(tmp_path / "r.mat").names == ("test.d.M",)

    def test_hdf5_group(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file["d/time"], file["d/M"] = np.arange(5.0) / 4, np.arange(5.0)
        assert read_recording(tmp_path / "r.h5").sampling_rate == pytest.approx(4)


def test_written_whole_in_memory_first(tmp_path):
    """The HDF5 file is a file like any other afterwards."""
    h5py = pytest.importorskip("h5py")
    write_recording(record(), tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5") as file:
        np.testing.assert_array_equal(file["T_T"][:], record()["T_T"].values)


def test_what_pyarrow_imports_later_is_imported_before_the_limits_begin():
    pytest.importorskip("pandas")
    program = "import sys; from torsionnet.signals.foreign.parquet_content import load; load(); sys.exit('pandas' not in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
