"""Studies that are broken off go on where they were, and come to the same bytes whoever calculates."""

import errno
import json
import os
import random
import shutil
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from support import campaigns
from support.patience import PATIENCE, wait_for
from support.study_runs import CHUNK, VARIANTS, contents, deadly, deaf, processes_of_session, small_study, started

from torsionnet.base.errors import SolveError, TorsionnetWarning, UsageError
from torsionnet.study.run import chunk_values, run_chunks
from torsionnet.study.run import run_chunks as workload
from torsionnet.study.run import study_folder as folder_lock
from torsionnet.study.run import study_folder as study_record
from torsionnet.study.run.process_pool import MOST_DEATHS, ProcessExecutor
from torsionnet.study.run.run_chunks import run_study
from torsionnet.study.run.study_folder import LOCK, locked

CHUNKS = 2 * VARIANTS // CHUNK


@pytest.fixture(autouse=True)
def many_chunks(monkeypatch):
    monkeypatch.setattr(workload, "CHUNK_POINTS", 1)
    monkeypatch.setattr(workload, "LEAST_CHUNK_SIZE", CHUNK)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a study that nothing has disturbed."""
    folder = tmp_path_factory.mktemp("whole") / "study"
    kept = workload.CHUNK_POINTS, workload.LEAST_CHUNK_SIZE
    workload.CHUNK_POINTS, workload.LEAST_CHUNK_SIZE = 1, CHUNK
    run_study(small_study(), folder)
    workload.CHUNK_POINTS, workload.LEAST_CHUNK_SIZE = kept
    assert len(contents(folder)) == CHUNKS + 1
    return folder


def chunk_files(folder):
    return sorted(file for file in (folder / "chunks").glob("*.npz") if not file.name.startswith("."))


def wait_for_chunks(folder, count):
    wait_for(lambda: (folder / "chunks").is_dir() and len(chunk_files(folder)) >= count, pause=0.005)


def kill(program):
    """The program alone; those that it has started have to see it for themselves."""
    program.send_signal(signal.SIGKILL)
    program.wait()


class TestSameBytes:
    @pytest.mark.slow
    def test_processes(self, whole, tmp_path):
        run_study(small_study(), tmp_path / "study", executor=ProcessExecutor(2))
        assert contents(tmp_path / "study") == contents(whole)

    @pytest.mark.slow
    def test_result_without_a_folder(self, whole):
        kept, free = run_study(small_study(), whole), run_study(small_study())
        assert json.dumps(kept.to_data()) == json.dumps(free.to_data())
        assert kept.values("f_1", "V").tobytes() == free.values("f_1", "V").tobytes()

    @pytest.mark.slow
    def test_every_variant_is_that_of_its_own_model(self, whole):
        """Against models that are made and solved one by one."""
        result = run_study(small_study(), whole)
        for index in (0, CHUNK - 1, CHUNK, VARIANTS - 1):
            model = result.model(index, "V")
            assert result.values("f_1", "V")[index] == pytest.approx(model.modes().natural_frequencies[0], rel=1e-9)

    def test_sums_of_curves(self):
        """Against curves of models that are solved one by one."""
        result = run_study(small_study(10))
        measure = result.summary("H", "V").measure
        curves = np.array(
            [
                abs(
                    result.model(n, "V")
                    .frequency_response("theta_1", "T_M", frequencies=measure.points)
                    .values[:, 0, 0]
                )
                for n in range(10)
            ]
        )
        moments = result.summary("H", "V").moments
        np.testing.assert_allclose(moments.mean, curves.mean(axis=0), rtol=1e-10)
        np.testing.assert_allclose(moments.deviation, curves.std(axis=0, ddof=1), rtol=1e-7)
        assert moments.largest_at.tolist() == curves.argmax(axis=0).tolist()
        ranks = np.sort(curves, axis=0)[[4, 8]]
        np.testing.assert_allclose(result.percentiles("H", [50, 90], "V"), ranks, rtol=0.002)


class TestFolder:
    @pytest.mark.slow
    def test_what_is_there_is_not_calculated_again(self, whole, tmp_path, monkeypatch):
        shutil.copytree(whole, tmp_path / "study")
        monkeypatch.setattr(run_chunks.ChunkWork, "__call__", lambda *_: pytest.fail("calculated"))
        told = []
        run_study(small_study(), tmp_path / "study", progress=lambda done, total: told.append((done, total)))
        assert told == [(CHUNKS, CHUNKS)]

    @pytest.mark.few(1)
    @pytest.mark.parametrize("spoil", [lambda data: data[:-100], lambda _: b"", lambda _: b"junk" * 100])
    def test_damaged_chunks_are_done_again(self, whole, tmp_path, spoil):
        folder = tmp_path / "study"
        shutil.copytree(whole, folder)
        victim = chunk_files(folder)[3]
        victim.write_bytes(spoil(victim.read_bytes()))
        run_study(small_study(), folder)
        assert contents(folder) == contents(whole)

    @pytest.mark.slow
    def test_any_flipped_bit_is_seen(self, whole, tmp_path):
        """Wherever it is, the chunk counts as damaged, or says the same as before."""
        folder = tmp_path / "study"
        shutil.copytree(whole, folder)
        victim = chunk_files(folder)[0]
        good = victim.read_bytes()
        expected = run_study(small_study(), whole).to_data()
        for place in random.Random(1).sample(range(len(good)), campaigns.examples(5, 20)):
            data = bytearray(good)
            data[place] ^= 1 << place % 8
            victim.write_bytes(bytes(data))
            assert run_study(small_study(), folder).to_data() == expected

    @pytest.mark.slow
    def test_what_killed_writers_left_goes_once_it_is_old(self, whole, tmp_path):
        folder = tmp_path / "study"
        shutil.copytree(whole, folder)
        old, young = (folder / "chunks" / f".00000001.npz.{name}.npz" for name in ("old", "young"))
        for file in (old, young):
            file.write_bytes(b"half a chunk")
        os.utime(old, (0, 0))
        run_study(small_study(), folder)
        assert [old.exists(), young.exists()] == [False, True]

    @pytest.mark.parametrize("record", ["", "[]", '{"format": 2', "\x00"])
    def test_a_damaged_record_is_refused_and_nothing_touched(self, whole, tmp_path, record):
        folder = tmp_path / "study"
        shutil.copytree(whole, folder)
        (folder / "study.json").write_text(record)
        before = contents(folder)
        with pytest.raises(UsageError, match="unreadable-file"):
            run_study(small_study(), folder)
        assert contents(folder) == before

    def test_another_study_is_refused_and_nothing_touched(self, whole):
        before = contents(whole)
        with pytest.raises(UsageError, match="unusable-place"):
            run_study(small_study(sampling={"count": VARIANTS, "seed": 2}), whole)
        assert contents(whole) == before

    def test_another_model_is_refused(self, whole):
        study = small_study()
        object.__setattr__(study, "model", study.model.configured(c_M=0.31))
        with pytest.raises(UsageError, match="model is another"):
            run_study(study, whole)

    def test_complete_results_of_another_minor_version_are_read(self, whole, monkeypatch):
        before = contents(whole)
        major = study_record.__version__.partition(".")[0]
        monkeypatch.setattr(study_record, "__version__", f"{major}.99.0")
        with pytest.warns(TorsionnetWarning, match=r".* now it is \d+\.99\.0"):
            run_study(small_study(), whole)
        assert contents(whole) == before

    def test_incomplete_results_of_another_minor_version_are_refused(self, whole, monkeypatch, tmp_path):
        part = shutil.copytree(whole, tmp_path / "part")
        next((part / "chunks").iterdir()).unlink()
        monkeypatch.setattr(study_record, "__version__", f"{study_record.__version__.partition('.')[0]}.99.0")
        with pytest.raises(UsageError, match="unusable-place"):
            run_study(small_study(), part)

    def test_another_version_is_refused(self, whole, monkeypatch):
        monkeypatch.setattr(study_record, "__version__", "99.0.0")
        with pytest.raises(UsageError, match=r"(?s)99\.0\.0.*unusable-place"):
            run_study(small_study(), whole)

    @pytest.mark.slow
    def test_full_disk(self, tmp_path, monkeypatch, whole):
        folder, write, left = tmp_path / "study", chunk_values.write_bytes, iter(range(5))

        def full(path, data):
            if next(left, None) is None:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            write(path, data)

        monkeypatch.setattr(chunk_values, "write_bytes", full)
        with pytest.raises(SolveError, match=r"(?s)full.*unusable-place"):
            run_study(small_study(), folder)
        assert len(chunk_files(folder)) == 5
        assert not (folder / LOCK).exists()
        monkeypatch.setattr(chunk_values, "write_bytes", write)
        run_study(small_study(), folder)
        assert contents(folder) == contents(whole)


class TestLock:
    def test_two_runs(self, tmp_path):
        with locked(tmp_path):
            with pytest.raises(UsageError, match=f"process {os.getpid()} "), locked(tmp_path):
                pass
            assert (tmp_path / LOCK).exists()
        assert not any(tmp_path.iterdir())

    @pytest.mark.parametrize("left", ["", "{", '{"host": 1}'])
    def test_a_lock_that_says_nothing(self, tmp_path, left):
        (tmp_path / LOCK).write_text(left)
        with locked(tmp_path):
            pass

    def test_a_process_that_has_died_and_whose_number_is_another_s_now(self, tmp_path):
        own = {"host": folder_lock.platform.node(), "process": os.getpid(), "began": "some other time"}
        (tmp_path / LOCK).write_text(json.dumps(own))
        with locked(tmp_path):
            pass

    def test_another_machine(self, tmp_path):
        (tmp_path / LOCK).write_text(json.dumps({"host": "elsewhere", "process": 1, "began": None}))
        with pytest.raises(UsageError, match=r"(?s)elsewhere.*unusable-place"), locked(tmp_path):
            pass


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="asks the system for its processes")
class TestKilled:
    @pytest.mark.slow
    @pytest.mark.parametrize("processes", [pytest.param(1, marks=pytest.mark.nightly), 2])
    def test_client(self, whole, tmp_path, processes):
        folder = tmp_path / "study"
        program = started(folder, processes)
        wait_for_chunks(folder, 5)
        kill(program)
        assert (folder / LOCK).exists()
        wait_for(lambda: not processes_of_session(program.pid))
        run_study(small_study(), folder)
        assert contents(folder) == contents(whole)

    @pytest.mark.slow
    def test_worker(self, whole, tmp_path):
        folder = tmp_path / "study"
        program = started(folder, 2)
        wait_for_chunks(folder, 5)
        workers = [one for one in processes_of_session(program.pid) if one != program.pid]
        os.kill(max(workers), signal.SIGKILL)
        assert program.wait(PATIENCE) == 0
        assert contents(folder) == contents(whole)

    @pytest.mark.slow
    def test_a_hundred_times_at_random(self, whole, tmp_path):
        """Each study is killed twice, or in the night until it is done and for a hundred kills; moments are of a fixed seed."""
        rng, kills, study = random.Random(18), 0, 0
        while kills < campaigns.examples(1, 100):
            folder, study = tmp_path / f"study_{study}", study + 1
            for _ in range(campaigns.examples(2, 50)):
                program = started(folder, rng.choice([1, 2]))
                wait_for_chunks(folder, 0)
                wait = time.monotonic() + rng.uniform(0.0, 0.3)
                while time.monotonic() < wait and program.poll() is None:
                    time.sleep(0.002)
                if program.poll() is not None:
                    assert program.returncode == 0
                    break
                kill(program)
                kills += 1
            run_study(small_study(), folder)
            assert contents(folder) == contents(whole)

    @pytest.mark.slow
    def test_a_chunk_that_kills_whoever_does_it(self):
        with pytest.raises(SolveError, match=f"{MOST_DEATHS} processes died while chunk 7"):
            list(ProcessExecutor(1).map(deadly, [7]))


def test_lock_where_files_have_one_name_only(tmp_path, monkeypatch):
    """As on exFAT and some shares of a network."""

    def refuse(*_args):
        raise OSError(95, "Operation not supported")

    monkeypatch.setattr("os.link", refuse)
    with locked(tmp_path):
        assert (tmp_path / LOCK).exists()
        with pytest.raises(UsageError, match="is running this study"), locked(tmp_path):
            pass
    assert not (tmp_path / LOCK).exists()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="there are no such masks")
def test_ctrl_c_is_for_this_process_even_while_others_start():
    assert dict(ProcessExecutor(1).map(deaf, [0])) == {0: True}
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
