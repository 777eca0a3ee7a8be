"""Studies on workers of dask.distributed: what they come to, what is refused, and what is lost when something dies."""

import json
import os
import random
import re
import signal
import socket
import sys
import threading
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace

import pytest
from support import campaigns
from support.cluster_processes import STUDY_CLIENT, client, kill_all_of, process, scheduler, workers
from support.cluster_work import DeadlyWork, FailingWork, NoiseWork, Prepared, noise
from support.patience import PATIENCE, wait_for

from torsionnet.base.errors import MissingExtraError, ModelError, UsageError
from torsionnet.study.run import chunk_task, dask_executor
from torsionnet.study.run import chunk_task as cluster_losses
from torsionnet.study.run.chunk_task import ClusterError
from torsionnet.study.run.dask_executor import TASKS_AHEAD, DaskExecutor, check_folder, connected, folder_fault

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="needs dask.distributed")


def is_whole(folder, count):
    """Whether there are all chunks, with the right bytes, and no others."""
    files = {file.name: file.read_bytes() for file in Path(folder).glob("chunk_*")}
    return files == {NoiseWork(str(folder)).file(number).name: noise(number) for number in range(count)}


def chunks_there(folder):
    return len(list(Path(folder).glob("chunk_*")))


@pytest.fixture(scope="module")
def local():
    """A client of two processes of this machine."""
    kept = {name: os.environ.get(name) for name in ("MALLOC_TRIM_THRESHOLD_", "OMP_NUM_THREADS")}
    with connected("local:2") as found:
        yield found
    assert kept == {name: os.environ.get(name) for name in kept}


@pytest.fixture
def study_folder(tmp_path):
    folder = tmp_path / "study"
    folder.mkdir()
    return folder


class TestAddress:
    def test_no_address(self):
        with pytest.raises(UsageError, match="wrong-form"), connected("somewhere"):
            pass
        with pytest.raises(UsageError, match="local:1 or more"), connected("local:0"):
            pass
        with pytest.raises(UsageError, match="missing port number"), connected("tcp://127.0.0.1"):
            pass

    def test_scheduler_file(self, tmp_path):
        file = tmp_path / "scheduler.json"
        with pytest.raises(UsageError, match="missing-file"), connected(str(file)):
            pass
        for text in ("", "[]", "{}", "\x00"):
            file.write_text(text)
            with pytest.raises(UsageError, match="is no scheduler file"), connected(str(file)):
                pass

    @pytest.mark.slow
    def test_nobody_answers(self, tmp_path):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
            file = tmp_path / "scheduler.json"
            file.write_text(json.dumps({"address": address}))
            for where in (address, str(file)):
                began = time.monotonic()
                told = f"no scheduler answers at {address} within 0.5 s.*firewall"
                with pytest.raises(UsageError, match=told), connected(where, 0.5):
                    pass
                assert time.monotonic() - began < 25  # 30 s is the time that dask itself would take

    @pytest.mark.slow
    def test_silence(self):
        with socket.socket() as silent:
            silent.bind(("127.0.0.1", 0))
            silent.listen()
            where = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
            with pytest.raises(UsageError, match="no scheduler answers"), connected(where, 0.5):
                pass

    def test_another_server(self):
        """A web server, whose first bytes read as the length of a message would need all memory there is."""
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            threading.Thread(target=_greet, args=(other,), daemon=True).start()
            where = f"tcp://127.0.0.1:{other.getsockname()[1]}"
            with pytest.raises(UsageError, match="failed-program"), connected(where, 2):
                pass

    @pytest.mark.slow
    def test_worker(self, local):
        address = next(iter(local.nthreads()))
        with pytest.raises(UsageError, match="wrong-form"), connected(address):
            pass

    def test_no_dask(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "distributed", None)
        with pytest.raises(MissingExtraError, match=r"torsionnet\[cluster\]"), connected("local:1"):
            pass


def _greet(server):
    connection, _ = server.accept()
    with connection:
        connection.sendall(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n" * 20)
        connection.recv(1000)


class TestExecutor:
    @pytest.mark.slow
    def test_all_chunks_once(self, local, study_folder):
        work = NoiseWork(str(study_folder), 0.01)
        found = list(DaskExecutor(local, study_folder).map(work, range(100)))
        assert sorted(found) == [(number, work(number)) for number in range(100)]
        assert is_whole(study_folder, 100)

    def test_prepared_once(self, local, study_folder):
        """What work has prepared for one chunk it has for the next, in each process; other work begins anew."""
        for number in range(2):
            found = list(DaskExecutor(local, study_folder).map(Prepared(study_folder / str(number)), range(100)))
            processes = {process for _, (process, _) in found}
            counts = {process: sorted(done for _, (who, done) in found if who == process) for process in processes}
            assert all(done == list(range(1, len(done) + 1)) for done in counts.values())

    def test_nothing_to_do(self, local, study_folder):
        assert list(DaskExecutor(local, study_folder).map(NoiseWork(str(study_folder)), [])) == []

    @pytest.mark.slow
    def test_few_tasks_wait(self, local, study_folder):
        """However many chunks there are, and however slowly they are taken."""
        bound = 2 * (1 + TASKS_AHEAD)
        for done, _ in enumerate(DaskExecutor(local, study_folder).map(NoiseWork(str(study_folder), 0), range(10**6))):
            assert len(local.futures) <= bound
            if done == 200:
                break
        wait_for(lambda: not local.futures)

    def test_surroundings_of_workers(self, local):
        """Memory is kept for the next chunk, and linear algebra has one thread."""
        for found in local.run(lambda: dict(os.environ)).values():
            assert int(found["MALLOC_TRIM_THRESHOLD_"]) >= 2**28
            assert found["OMP_NUM_THREADS"] == "1"

    def test_dashboard(self, local):
        assert local.dashboard_link.startswith("http://127.0.0.1:")

    @pytest.mark.slow
    def test_fault_of_the_study(self, local, study_folder):
        work = FailingWork(study_folder, ModelError("no such parameter"))
        with pytest.raises(ModelError, match="no such parameter"):
            list(DaskExecutor(local, study_folder).map(work, range(10)))

    def test_fault_of_a_worker(self, local, study_folder):
        with pytest.raises(ClusterError, match=r"(?s)chunk 3.*failed-program"):
            list(DaskExecutor(local, study_folder).map(FailingWork(study_folder, MemoryError()), [3]))
        with pytest.raises(OSError, match="No space left") as told:
            list(
                DaskExecutor(local, study_folder).map(
                    FailingWork(study_folder, OSError(28, "No space left on device")), [3]
                )
            )
        assert told.value.errno == 28

    def test_no_folder(self, local, study_folder):
        with pytest.raises(UsageError, match="missing-entry"):
            list(DaskExecutor(local, study_folder).map(FailingWork(None, MemoryError()), [1]))


class TestWorkers:
    def test_other_versions(self, local, study_folder, monkeypatch):
        """As this process sees it the others differ."""
        own, calls = chunk_task._of_process, []

        def without_numba_at_first(said):
            calls.append(said)
            return {**own(said), "numba": ""} if len(calls) == 1 else own(said)

        monkeypatch.setattr(chunk_task, "_of_process", without_numba_at_first)
        with pytest.raises(ClusterError, match=r"worker tcp://.* numba .* no numba"):
            list(DaskExecutor(local, study_folder).map(NoiseWork(str(study_folder)), range(3)))
        assert chunks_there(study_folder) == 0

    def test_many_faults(self):
        with pytest.raises(ClusterError, match=r"(?s)fault 9.*and 90 more"):
            chunk_task.refuse_faults([f"fault {number}" for number in range(100)], "Mend them")

    def test_kinds_of_machines(self):
        def told(machine):
            return {
                "host": {"python": "3.12.1.final.0", "machine": machine},
                "packages": dict.fromkeys(chunk_task.PACKAGES, "1.0"),
            }

        seen = {"client": told("arm64"), "workers": {"tcp://a:1": told("x86_64"), "tcp://b:1": told("aarch64")}}
        cluster = SimpleNamespace(get_versions=lambda **_: seen)
        with pytest.raises(ClusterError, match=r"(?s)aarch64.*failed-program"):
            chunk_task.check_versions(cluster)
        del seen["workers"]["tcp://b:1"]
        chunk_task.check_versions(cluster)

    def test_folder_not_shared(self, study_folder, tmp_path):
        other = tmp_path / "other"
        other.mkdir()

        def run(work, token, word, **_):
            return {"tcp://a:1": work(token, word), "tcp://b:1": work(str(other / Path(token).name), word)}

        with pytest.raises(ClusterError, match=r"^worker tcp://b:1: .*other is not there.*\nAll workers need .*study "):
            check_folder(SimpleNamespace(run=run), study_folder)
        assert not list(study_folder.iterdir())

    def test_trouble_with_folders(self, study_folder, monkeypatch):
        token = study_folder / "token"
        token.write_text("word")
        assert folder_fault(str(token), "word") == ""
        assert "another folder" in folder_fault(str(token), "other word")
        assert [file.name for file in study_folder.iterdir()] == ["token"]

        def full(_):
            raise OSError(30, "Read-only file system")

        monkeypatch.setattr(dask_executor.Path, "touch", full)
        assert "Read-only file system" in folder_fault(str(token), "word")


@pytest.mark.slow
def test_no_workers_yet_is_said_while_it_waits(tmp_path, monkeypatch):
    """A scheduler whose workers join at the third look, and what comes after their versions does not matter."""
    monkeypatch.setattr(cluster_losses, "LOOK_EVERY", 0.0)
    monkeypatch.setattr(cluster_losses, "SAID_FIRST", 0.0)

    class JoinedError(Exception):
        pass

    class Scheduler:
        status = "running"
        looks = iter([{}, {}, {}, {"tcp://n7:9": 4}])

        def nthreads(self):
            return next(self.looks)

        def get_versions(self, **_packages):
            raise JoinedError

    said = []
    with pytest.raises(JoinedError):
        next(DaskExecutor(Scheduler(), tmp_path, said.append).map(len, [()]))
    assert said[0].startswith("the scheduler has no workers yet; waiting")
    assert said[1] == "no workers yet for 0 s"


@pytest.mark.slow
@pytest.mark.parametrize("fetched_late", [False, True])
def test_no_workers_any_more_is_said_while_it_waits(study_folder, monkeypatch, fetched_late):
    """All workers go while chunks are left; it is said as often as at the beginning, and others go on.

    With them go chunks in hand, and what they had calculated and nobody had fetched.
    """
    from distributed import Client, LocalCluster

    monkeypatch.setattr(cluster_losses, "SAID_FIRST", 0.2)
    monkeypatch.setattr(dask_executor, "LOOK_EVERY", 0.05)
    monkeypatch.setattr(dask_executor, "TASK_SECONDS", 0.0)
    asked = {"processes": False, "threads_per_worker": 1, "dashboard_address": ":0"}
    with LocalCluster(n_workers=1, **asked) as cluster, Client(cluster, set_as_default=False) as user:
        said = []

        def told(text):
            said.append(text)
            if len(said) == 3:
                cluster.scale(1)

        rescue = threading.Timer(PATIENCE, cluster.scale, [1])  # without words nothing else would end the test
        rescue.start()
        work = NoiseWork(str(study_folder), 0.2)
        for done, _ in enumerate(DaskExecutor(user, study_folder, told).map(work, range(40))):
            if done == 5:
                if fetched_late:
                    wait_for(lambda: chunks_there(study_folder) > 7)
                cluster.scale(0)
                wait_for(lambda: not user.nthreads())
        rescue.cancel()
    assert is_whole(study_folder, 40)
    assert len(said) >= 3
    assert re.match(r"the scheduler has no workers now, \d+ chunks left; waiting for some to join", said[0])
    assert re.match(r"no workers now for \d+ s, \d+ chunks left", said[1])


@pytest.mark.slow
class TestOtherWorkers:
    @pytest.fixture
    def old(self, tmp_path):
        """A folder before all others in which another version of the package says it is installed."""
        folder = tmp_path / "old" / "torsionnet-0.0.1.dist-info"
        folder.mkdir(parents=True)
        (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: torsionnet\nVersion: 0.0.1\n")
        return folder.parent

    def test_another_version(self, tmp_path, study_folder, old):
        with scheduler(tmp_path) as (file, _), workers(file, before=[old]), connected(str(file)) as cluster:
            cluster.wait_for_workers(1, timeout=PATIENCE)
            with pytest.raises(ClusterError, match=r"worker tcp.* torsionnet 0.0.1"):
                list(DaskExecutor(cluster, study_folder).map(NoiseWork(str(study_folder)), range(3)))
            assert not list(study_folder.iterdir())

    @pytest.mark.nightly
    def test_another_version_joins(self, tmp_path, study_folder, old):
        with scheduler(tmp_path) as (file, _), workers(file), connected(str(file)) as cluster:
            cluster.wait_for_workers(1, timeout=PATIENCE)
            running = DaskExecutor(cluster, study_folder).map(NoiseWork(str(study_folder)), range(10**5))
            next(running)
            with workers(file, before=[old]), pytest.raises(ClusterError, match=r"process .* torsionnet 0.0.1"):
                list(running)
            assert chunks_there(study_folder) > 0

    @pytest.mark.nightly
    def test_workers_that_join_later(self, tmp_path, study_folder):
        """None is there at first; the second comes when the first is busy, and both have done something."""
        with scheduler(tmp_path) as (file, _), client(file, study_folder, 150) as running:
            time.sleep(1)
            with workers(file):
                wait_for(lambda: chunks_there(study_folder) > 10)
                with workers(file), connected(str(file)) as cluster:
                    wait_for(lambda: len(cluster.nthreads()) == 2)
                    assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 150)


@pytest.mark.slow
class TestKills:
    def test_worker(self, tmp_path, study_folder):
        """A nanny replaces it, others do its chunks."""
        with (
            scheduler(tmp_path) as (file, _),
            workers(file, 2),
            connected(str(file)) as cluster,
            client(file, study_folder, 150) as running,
        ):
            for reached in (20, 60, 100)[: campaigns.examples(1, 3)]:
                wait_for(lambda reached=reached: chunks_there(study_folder) > reached and cluster.nthreads())
                os.kill(random.choice(list(cluster.run(os.getpid).values())), signal.SIGKILL)
            assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 150)

    @pytest.mark.nightly
    def test_all_workers_with_their_nannies(self, tmp_path, study_folder):
        """Those that come after them go on, without the client being started again."""
        with scheduler(tmp_path) as (file, _), client(file, study_folder, 100) as running:
            with workers(file, 2) as first:
                wait_for(lambda: chunks_there(study_folder) > 20)
                kill_all_of(first)
            with workers(file, 2):
                assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 100)

    def test_deadly_chunk(self, tmp_path, study_folder):
        """It does not take one worker after the other for ever."""
        with scheduler(tmp_path) as (file, _), workers(file, 2), connected(str(file)) as cluster:
            cluster.wait_for_workers(2, timeout=PATIENCE)
            with pytest.raises(ClusterError, match=r"(?s)chunk 7.*failed-program"):
                list(DaskExecutor(cluster, study_folder).map(DeadlyWork(study_folder), [7]))

    @pytest.mark.nightly
    def test_client(self, tmp_path, study_folder):
        with scheduler(tmp_path) as (file, _), workers(file, 2):
            with client(file, study_folder, 150) as running:
                wait_for(lambda: chunks_there(study_folder) > 20)
                kill_all_of(running)
            assert chunks_there(study_folder) < 150
            with client(file, study_folder, 150) as running:
                assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 150)

    def test_client_with_its_own_workers(self, study_folder):
        """Only the client is killed: its workers end by themselves."""
        psutil = pytest.importorskip("psutil")
        with client("local:2", study_folder, 200) as running:
            wait_for(lambda: chunks_there(study_folder) > 20)
            children = psutil.Process(running.pid).children(recursive=True)
            assert len(children) >= 2
            os.kill(running.pid, signal.SIGKILL)
            psutil.wait_procs(children, timeout=PATIENCE)
            assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
        assert chunks_there(study_folder) < 200
        with client("local:2", study_folder, 200) as running:
            assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 200)

    @pytest.mark.nightly
    def test_scheduler(self, tmp_path, study_folder):
        with scheduler(tmp_path) as (file, started), workers(file, 2), client(file, study_folder, 150) as running:
            wait_for(lambda: chunks_there(study_folder) > 20)
            kill_all_of(started)
            assert running.wait(PATIENCE) == 1
            assert "the connection to the scheduler is lost; what was calculated is kept" in running.said()
        assert chunks_there(study_folder) < 150
        with scheduler(tmp_path) as (file, _), workers(file, 2), client(file, study_folder, 150) as running:
            assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 150)

    @pytest.mark.nightly
    def test_campaign(self, tmp_path, study_folder):
        """Ten kills of anything at any time."""
        chance = random.Random(1)
        for _ in range(10):
            with (
                scheduler(tmp_path) as (file, started),
                workers(file, 2) as working,
                client(file, study_folder, 1000) as running,
            ):
                time.sleep(chance.uniform(1, 4))
                kill_all_of(chance.choice([started, working, running]))
                time.sleep(0.5)
        with scheduler(tmp_path) as (file, _), workers(file, 2), client(file, study_folder, 1000) as running:
            assert running.wait(PATIENCE) == 0, running.said()
        assert is_whole(study_folder, 1000)


STUDY = """
torsionnet: 1
model: amt_rig
configurations: [II, V]
vary:
  k_1: {type: normal, deviation: 5 %}
  c_1: {type: uniform, low: -30 %, high: +30 %}
sampling: {method: sobol, count: 1024}
quantities:
  f_1: {type: natural_frequency, mode: 1}
  flexibility: {type: response, output: theta_1, input: T_T, band: 0.5..30 Hz, points: 20000}
"""


@pytest.mark.nightly
def test_study_through_all_losses(tmp_path, study_folder):
    """A whole study, whose scheduler and then whose client is killed, to the last byte what one process comes to.

    Who is killed while writing leaves a hidden file beside the chunks, which is none of them.
    """
    from torsionnet.study.run.run_chunks import run_study
    from torsionnet.study.study import load_study

    file = tmp_path / "study.yaml"
    file.write_text(STUDY)
    alone = run_study(load_study(file), tmp_path / "alone")
    chunks = sorted((tmp_path / "alone" / "chunks").iterdir())
    assert len(chunks) >= 8

    def there():
        return len(list((study_folder / "chunks").glob("[0-9]*.npz")))

    def asked_for(where):
        return process("-c", STUDY_CLIENT, file, where, study_folder)

    with scheduler(tmp_path) as (where, started), workers(where, 2), asked_for(where) as running:
        wait_for(lambda: there() > 1, says=running.said)
        kill_all_of(started)
        assert running.wait(PATIENCE) == 1
        assert "the connection to the scheduler is lost" in running.said()
    first = there()
    with asked_for("local:2") as running:
        wait_for(lambda: there() > first, says=running.said)
        kill_all_of(running)
    assert there() < len(chunks)
    with asked_for("local:1") as running:
        assert running.wait(PATIENCE) == 0, running.said()
        assert alone.table().to_text() in running.said()
    assert [one.read_bytes() for one in sorted((study_folder / "chunks").glob("[0-9]*.npz"))] == [
        one.read_bytes() for one in chunks
    ]


@pytest.mark.slow
def test_answers_on_a_cluster(local, study_folder, monkeypatch):
    """Workers write what they calculate, this process reads it; the answer is that of one process."""
    from support.study_runs import answers_as_text, study_of_answers

    from torsionnet.study.quantities.evaluator import Evaluator
    from torsionnet.study.run import evaluation_memory
    from torsionnet.study.run.answering import Workers

    @contextmanager
    def these(_):
        yield local

    monkeypatch.setattr("torsionnet.study.run.dask_executor.connected", these)
    monkeypatch.setattr(evaluation_memory, "LEAST_SHARED_SECONDS", 0.0)
    monkeypatch.setattr(evaluation_memory, "LEAST_CALL_SECONDS", 0.0)
    study = study_of_answers(("shares", "worst"))
    alone = answers_as_text(study)
    assert answers_as_text(study, study_folder, Workers(cluster="local:2")) == alone
    assert len(list((study_folder / "answers").glob("*.log"))) in (2, 3)  # of this process, and who did something
    monkeypatch.setattr(Evaluator, "rows", lambda *_: pytest.fail("calculated"))
    assert answers_as_text(study, study_folder) == alone


@pytest.mark.nightly
def test_slurm_recipe_of_the_page(tmp_path, monkeypatch, capsys):
    """It leaves a scheduler file that works, and its jobs start workers of one thread that keep their memory."""
    jobqueue = pytest.importorskip("dask_jobqueue")
    page = (Path(__file__).parents[2] / "docs" / "how_to" / "studies_on_a_cluster.md").read_text(encoding="utf-8")
    program = next(text for text in page.split("```py\n") if text.startswith("# slurm_workers.py")).partition("```")[0]
    asked, seen = [], []
    monkeypatch.setattr(jobqueue.SLURMCluster, "scale", lambda _, jobs: asked.append(jobs))

    def wait(_):
        with connected(str(tmp_path / "cluster.json")) as cluster:
            seen.append(cluster.nthreads())
        raise KeyboardInterrupt

    monkeypatch.setitem(sys.modules, "time", SimpleNamespace(**{**vars(time), "sleep": wait}))
    with pytest.raises(KeyboardInterrupt):
        exec(program.replace("/shared/cluster.json", str(tmp_path / "cluster.json")), {})
    script = capsys.readouterr().out
    assert (asked[0], seen) == (8, [{}])
    assert "export MALLOC_TRIM_THRESHOLD_=1073741824" in script
    assert "--nthreads 1 " in script
    assert "--nworkers 16 " in script
