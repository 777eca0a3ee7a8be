"""Answers that choose their variants themselves: kept while they are found, shared among workers, never different."""

import errno
import json
import os
import random
import signal
import time
from pathlib import Path

import pytest
from click.testing import CliRunner
from support import campaigns
from support.patience import wait_for
from support.study_runs import answers_as_text, processes_of_session, small_study, started, study_of_answers

from torsionnet.app.cli.app import app
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.study.quantities.evaluator import Evaluator
from torsionnet.study.run import evaluation_memory
from torsionnet.study.run.answering import Workers, answer_study
from torsionnet.study.run.evaluation_memory import EvaluationLog, EvaluationMemory, record_at, records
from torsionnet.study.run.process_pool import ProcessExecutor
from torsionnet.study.run.study_folder import LOCK

FEW = ("shares", "worst", "map")


@pytest.fixture(scope="module")
def expected():
    """What all answers come to where nothing is kept or shared."""
    return answers_as_text(study_of_answers())


@pytest.fixture(scope="module")
def few():
    return answers_as_text(study_of_answers(FEW))


@pytest.fixture
def all_shared(monkeypatch):
    monkeypatch.setattr(evaluation_memory, "LEAST_SHARED_SECONDS", 0.0)
    monkeypatch.setattr(evaluation_memory, "LEAST_CALL_SECONDS", 0.0)


def logs(folder):
    return sorted((folder / "answers").glob("*.log"))


def kept_bytes(folder):
    return sum(file.stat().st_size for file in logs(folder))


def count_rows(monkeypatch):
    """How many variants this process calculates from now on."""
    rows, counted = Evaluator.rows, []

    def counting(self, values, names):
        counted.append(len(next(iter(values.values()))))
        return rows(self, values, names)

    monkeypatch.setattr(Evaluator, "rows", counting)
    return counted


class TestLog:
    def written(self, folder, count=5):
        log = EvaluationLog(folder)
        for number in range(count):
            log.append(bytes([number]) * 32, b"x" * 8 * number)
        log.close()
        return next(folder.iterdir())

    def test_records_come_back(self, tmp_path):
        found = list(records(self.written(tmp_path)))
        assert [key[0] for key, _ in found] == [0, 1, 2, 3, 4]
        assert record_at(tmp_path, found[3][1]) == (b"\3" * 32, b"x" * 24)

    def test_every_end_of_a_killed_writer(self, tmp_path):
        """Cut anywhere, what was whole before the cut is there and nothing else."""
        file = self.written(tmp_path)
        data = file.read_bytes()
        ends = [place.start + place.length for _, place in records(file)]
        for cut in range(len(data)):
            file.write_bytes(data[:cut])
            assert len(list(records(file))) == sum(end <= cut for end in ends)

    def test_any_flipped_bit_ends_what_is_believed(self, tmp_path):
        file = self.written(tmp_path)
        data = file.read_bytes()
        places = [place for _, place in records(file)]
        for at in range(len(data)):
            spoilt = bytearray(data)
            spoilt[at] ^= 1 << at % 8
            file.write_bytes(spoilt)
            assert len(list(records(file))) == sum(one.start + one.length <= at for one in places)

    def test_after_half_a_record_another_file_begins(self, tmp_path):
        log = EvaluationLog(tmp_path)
        log.append(b"a" * 32, b"x" * 8)

        class Full:
            name = str(next(tmp_path.iterdir()))

            def seek(self, *_):
                return 0

            def write(self, record):
                return len(record) - 1

            def close(self):
                pass

        log._file.close()
        log._file = Full()
        with pytest.raises(OSError, match="No space"):
            log.append(b"b" * 32, b"x" * 8)
        place = log.append(b"c" * 32, b"x" * 8)
        log.close()
        assert len(list(tmp_path.iterdir())) == 2
        assert record_at(tmp_path, place) == (b"c" * 32, b"x" * 8)

    def test_a_folder_that_was_removed_meanwhile(self, tmp_path):
        log = EvaluationLog(tmp_path / "answers")
        for name in (b"a", b"b"):
            place = log.append(name * 32, b"x" * 8)
            assert record_at(log.folder, place) == (name * 32, b"x" * 8)
            (log.folder / place.file).unlink()
            log.folder.rmdir()
        log.close()


class TestSameResult:
    @pytest.mark.slow
    @pytest.mark.parametrize("answers", [FEW, pytest.param((), marks=pytest.mark.nightly)], ids=["few", "all"])
    def test_with_a_folder_and_again(self, answers, request, tmp_path, monkeypatch):
        expected = request.getfixturevalue("few" if answers else "expected")
        assert answers_as_text(study_of_answers(answers), tmp_path / "study") == expected
        counted = count_rows(monkeypatch)
        size = kept_bytes(tmp_path / "study")
        assert answers_as_text(study_of_answers(answers), tmp_path / "study") == expected
        assert (counted, kept_bytes(tmp_path / "study")) == ([], size)
        assert not (tmp_path / "study" / LOCK).exists()

    @pytest.mark.slow
    @pytest.mark.usefixtures("all_shared")
    @pytest.mark.parametrize("keep", [pytest.param(True, marks=pytest.mark.nightly), False])
    def test_processes(self, few, tmp_path, monkeypatch, keep):
        counted = count_rows(monkeypatch)
        folder = tmp_path / "study" if keep else None
        assert answers_as_text(study_of_answers(FEW), folder, Workers(processes=2)) == few
        assert counted[:2] == [500, 500]  # of 2048, the others were for the two
        assert counted[2] < 500
        assert len(logs(tmp_path / "study")) in ((2, 3) if keep else (0,))  # one for each process that did something
        counted.clear()
        assert answers_as_text(study_of_answers(FEW), folder) == few
        assert (counted == []) == keep

    @pytest.mark.slow
    def test_nothing_is_written_without_a_folder(self, few, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert answers_as_text(study_of_answers(FEW)) == few
        assert not any(tmp_path.iterdir())

    @pytest.mark.slow
    def test_a_folder_that_is_full(self, few, tmp_path, monkeypatch):
        monkeypatch.setattr(evaluation_memory, "MOST_LOG_BYTES", 10_000)
        assert answers_as_text(study_of_answers(FEW), tmp_path / "study") == few
        assert 10_000 <= kept_bytes(tmp_path / "study") < 20_000  # one block of 500 beyond it at most
        assert answers_as_text(study_of_answers(FEW), tmp_path / "study") == few

    def test_limits_may_change_and_variants_are_known(self, tmp_path, monkeypatch):
        """The margin of a failure is made of the same values, whatever the limit."""
        answer_study(study_of_answers(("shares",)), tmp_path / "study")
        counted = count_rows(monkeypatch)
        again = study_of_answers(("shares",))
        object.__setattr__(again, "limits", {})
        answer_study(again, tmp_path / "study")
        assert counted == []


class TestFolder:
    @pytest.mark.slow
    def test_damaged_records_are_calculated_again(self, few, tmp_path):
        folder = tmp_path / "study"
        answers_as_text(study_of_answers(FEW), folder)
        (file,) = logs(folder)
        good, chance = file.read_bytes(), random.Random(3)
        for at in chance.sample(range(len(good)), 5):
            spoilt = bytearray(good)
            spoilt[at] ^= 64
            file.write_bytes(spoilt)
            assert answers_as_text(study_of_answers(FEW), folder) == few

    @pytest.mark.slow
    def test_a_record_that_is_spoilt_while_the_study_runs(self, few, tmp_path, monkeypatch):
        folder = tmp_path / "study"
        answers_as_text(study_of_answers(FEW), folder)
        of = EvaluationMemory.of

        def spoil(folder):
            memory = of(folder)
            (file,) = logs(folder)
            file.write_bytes(file.read_bytes()[:1000])
            return memory

        monkeypatch.setattr(EvaluationMemory, "of", spoil)
        assert answers_as_text(study_of_answers(FEW), folder) == few

    def test_another_study_is_refused_and_nothing_touched(self, tmp_path):
        folder = tmp_path / "study"
        answer_study(study_of_answers(("map",)), folder)
        before = logs(folder)[0].read_bytes()
        other = study_of_answers(("map",))
        object.__setattr__(other, "model", other.model.configured(c_1=0.31))
        with pytest.raises(UsageError, match="model is another"):
            answer_study(other, folder)
        assert [file.read_bytes() for file in logs(folder)] == [before]

    def test_logs_of_nobody_knows_what(self, tmp_path):
        folder = tmp_path / "study"
        answer_study(study_of_answers(("map",)), folder)
        (folder / "study.json").unlink()
        with pytest.raises(UsageError, match="unusable-place"):
            answer_study(study_of_answers(("map",)), folder)

    @pytest.mark.slow
    def test_full_disk(self, few, tmp_path, monkeypatch):
        folder, append, left = tmp_path / "study", EvaluationLog.append, iter(range(5))

        def full(*asked, **more):
            if next(left, None) is None:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return append(*asked, **more)

        monkeypatch.setattr(evaluation_memory.EvaluationLog, "append", full)
        with pytest.raises(SolveError, match="disk is full"):
            answers_as_text(study_of_answers(FEW), folder)
        assert not (folder / LOCK).exists()
        assert sum(1 for _ in records(logs(folder)[0])) == 5
        monkeypatch.setattr(evaluation_memory.EvaluationLog, "append", append)
        assert answers_as_text(study_of_answers(FEW), folder) == few

    @pytest.mark.slow
    def test_variants_and_answers_in_one_folder(self, tmp_path, monkeypatch):
        study = small_study(40, answers={"shares": {"type": "sobol_indices", "count": 64}, "yes": {"type": "scatter"}})
        whole = answer_study(study, tmp_path / "study")
        counted = count_rows(monkeypatch)
        again = answer_study(study, tmp_path / "study")
        assert json.dumps(again.conclusions["shares"].to_data()) == json.dumps(whole.conclusions["shares"].to_data())
        assert whole.result.to_data() == again.result.to_data()
        assert sum(counted) == 40  # tried before the variants, to say how long they take


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="asks the system for its processes")
class TestKilled:
    def until_kept(self, folder, size, program):
        wait_for(lambda: kept_bytes(folder) >= size or program.poll() is not None, pause=0.002)

    def ended(self, program):
        program.send_signal(signal.SIGKILL)
        program.wait()
        wait_for(lambda: not processes_of_session(program.pid))

    @pytest.mark.slow
    @pytest.mark.parametrize("processes", [1, pytest.param(2, marks=pytest.mark.nightly)])
    def test_at_several_moments(self, few, tmp_path, processes):
        """What was written stays, and each run goes on from there."""
        answers_as_text(study_of_answers(FEW), tmp_path / "whole")
        whole, folder = kept_bytes(tmp_path / "whole"), tmp_path / "study"
        for share in (0.02, 0.5, 0.9) if campaigns.many else (0.5,):
            program = started(folder, processes, "answers", *FEW)
            self.until_kept(folder, share * whole, program)
            assert program.poll() is None
            self.ended(program)
            assert kept_bytes(folder) < whole
        assert (folder / LOCK).exists()
        assert answers_as_text(study_of_answers(FEW), folder) == few
        keys = [key for file in logs(folder) for key, _ in records(file)]
        assert len(keys) - len(set(keys)) <= 3 * 2 * processes  # only what was in hand is calculated twice

    @pytest.mark.nightly
    def test_twenty_times_at_random(self, expected, tmp_path):
        chance, kills, study = random.Random(18), 0, 0
        while kills < 20:
            folder, study = tmp_path / f"study_{study}", study + 1
            for _ in range(50):
                program = started(folder, chance.choice([1, 1, 2]), "answers")
                self.until_kept(folder, kept_bytes(folder) + 1, program)
                until = time.monotonic() + chance.uniform(0.0, 4.0)
                while time.monotonic() < until and program.poll() is None:
                    time.sleep(0.002)
                if program.poll() is not None:
                    assert program.returncode == 0
                    assert folder.with_suffix(".json").read_text() == expected
                    break
                self.ended(program)
                kills += 1
            assert answers_as_text(study_of_answers(), folder) == expected


@pytest.mark.slow
def test_progress_counts_every_variant_once_and_knows_the_end_where_it_can(tmp_path):
    study = study_of_answers(FEW)
    told = {}
    for _ in range(2):  # the second time all is read back
        told.clear()
        answer_study(study, tmp_path / "study", answering=lambda name, *now: told.setdefault(name, []).append(now))
        assert told["shares"][0] == (0, 512 * 4)
        assert told["shares"][-1] == (512 * 4, 512 * 4)
        assert told["map"][-1] == (81, 81)
        assert told["worst"][-1][0] > 500
        assert told["worst"][-1][1] is None


def test_small_calls_stay_here(monkeypatch):
    """Starting processes for what is done in a moment would only cost."""

    class Refusing(ProcessExecutor):
        def map(self, *_):
            pytest.fail("handed out")

    monkeypatch.setattr("torsionnet.study.run.process_pool.ProcessExecutor", Refusing)
    answers_as_text(study_of_answers(("map",)), None, Workers(2))


def test_stopped_says_what_is_kept(tmp_path, monkeypatch):
    file = tmp_path / "plan.yaml"
    file.write_text(
        "torsionnet: 1\nmodel: dmf_rig\nvary: {k_2: {type: normal, deviation: 5 %}}\n"
        "quantities: {z: {type: damping_ratio, mode: 1}}\nanswers: {shares: {type: sobol_indices}}\n",
        encoding="utf-8",
    )

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Evaluator, "rows", stop)
    shown = CliRunner().invoke(app, ["study", str(file), "-o", str(tmp_path / "kept")])
    assert shown.exit_code != 0
    assert "what is done is in" in shown.stderr
    assert "the same command goes on from there" in shown.stderr
    shown = CliRunner().invoke(app, ["study", str(file)])
    assert shown.exit_code != 0
    assert "nothing is kept without a folder" in shown.stderr
