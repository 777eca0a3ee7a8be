"""Storing from the page: the one file it was started with, whole or not at all, and nothing for anybody else."""

import http.client
import json
import os
import stat
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from support.explore_pages import serving
from support.explore_texts import RIG
from support.patience import PATIENCE

from torsionnet.app.explore import disk_file
from torsionnet.app.explore.api import LARGEST_REQUEST, LARGEST_TEXT_REQUEST
from torsionnet.app.explore.disk_file import GONE, DiskFile
from torsionnet.model.files.library import MOST_BYTES

NEW = RIG.replace("400", "900")
links = pytest.mark.skipif(os.name == "nt", reason="links need rights of their own on Windows")


@pytest.fixture
def file(tmp_path):
    folder = tmp_path / "models"
    folder.mkdir()
    path = folder / "rig.yaml"
    path.write_text(RIG, encoding="utf-8")
    (tmp_path / "other.yaml").write_text("other: 1\n", encoding="utf-8")
    return path


@pytest.fixture
def server(file):
    with serving(str(file)) as found:
        yield found


def post(server, path, entries, token=None, **headers):
    """Status and content of one request of the page, or of somebody else."""
    port = server.server_address[1]
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    body = (
        entries
        if isinstance(entries, bytes)
        else json.dumps({"document": "tab", **entries}, ensure_ascii=False).encode(errors="surrogatepass")
    )
    given = {"Content-Type": "application/json", "Origin": f"http://127.0.0.1:{port}"}
    given |= {name.replace("_", "-"): value for name, value in headers.items()}
    try:
        connection.request("POST", f"/{token or server.guard.token}/api/{path}", body, given)
        reply = connection.getresponse()
        return reply.status, json.loads(reply.read())
    finally:
        connection.close()


def store(server, text, disk, **entries):
    return post(server, "store", {"text": text, "disk": disk, **entries})[1]


def test_it_is_stored_and_nothing_else_is_touched(server, file):
    disk = post(server, "open", {})[1]["disk"]
    done = store(server, NEW, disk)
    assert done["stored"]
    assert file.read_text(encoding="utf-8") == NEW
    assert [one.name for one in file.parent.iterdir()] == ["rig.yaml"]
    assert store(server, RIG, done["disk"])["stored"]
    assert post(server, "changes", {"disk": disk[:-1]})[1]["disk"] == disk  # the same content, the same version


def test_a_faulty_text_may_be_stored(server, file):
    disk = post(server, "open", {})[1]["disk"]
    assert store(server, "elements: [", disk)["stored"]
    assert file.read_text(encoding="utf-8") == "elements: ["


def test_a_file_changed_meanwhile_is_kept_and_the_difference_is_shown(server, file):
    disk = post(server, "open", {})[1]["disk"]
    other = RIG.replace("0.08", "0.09")
    file.write_text(other, encoding="utf-8")
    for force in (False, True):  # force says no more than: this version may go
        found = store(server, NEW, disk, force=force)
        assert found["stored"] is False
        assert "changed by another program" in found["reason"]
        assert found["text"] == other
        lines = found["difference"].splitlines()
        assert lines[:2] == ["--- rig.yaml on disk", "+++ rig.yaml on the page"]
        assert "-parameters: {k: 400 N*m/rad}" in lines
        assert "+parameters: {k: 900 N*m/rad}" in lines
        assert file.read_text(encoding="utf-8") == other
    assert store(server, NEW, found["disk"], force=True)["stored"]
    assert file.read_text(encoding="utf-8") == NEW


def test_a_touched_file_has_not_changed(server, file):
    disk = post(server, "open", {})[1]["disk"]
    os.utime(file, (1, 1))
    assert store(server, NEW, disk)["stored"]


def test_a_file_that_is_gone_is_written_anew_only_on_purpose(server, file):
    disk = post(server, "open", {})[1]["disk"]
    file.unlink()
    found = store(server, NEW, disk)
    assert (found["stored"], found["disk"], found["text"]) == (False, GONE, None)  # no text to take over
    assert not file.exists()
    assert store(server, NEW, GONE)["stored"]
    assert file.read_text(encoding="utf-8") == NEW


@links
def test_permissions_stay(server, file):
    file.chmod(0o640)
    assert store(server, NEW, post(server, "open", {})[1]["disk"])["stored"]
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


def test_a_read_only_file_is_not_written(file, monkeypatch):
    monkeypatch.setattr(disk_file.os, "access", lambda path, _: path != file.resolve())  # root may write everything
    with serving(str(file)) as server:
        opened = post(server, "open", {})[1]
        assert opened["can_save"] is False
        assert "read-only" in opened["save_hint"]
        assert "read-only" in store(server, NEW, opened["disk"])["reason"]
    assert file.read_text(encoding="utf-8") == RIG


def test_a_library_model_is_not_written():
    with serving("amt_rig") as server:
        opened = post(server, "open", {})[1]
        assert opened["can_save"] is False
        found = store(server, NEW, opened["disk"])
        assert (found["stored"], found["reason"]) == (False, opened["save_hint"])
        assert post(server, "open", {"document": "next"})[1]["text"] == opened["text"]


@links
class TestLinks:
    def test_a_link_named_at_the_start_is_followed(self, file, tmp_path):
        link = tmp_path / "link.yaml"
        link.symlink_to(file)
        with serving(str(link)) as server:
            assert store(server, NEW, post(server, "open", {})[1]["disk"])["stored"]
        assert link.is_symlink()
        assert file.read_text(encoding="utf-8") == NEW

    def test_a_link_that_leads_elsewhere_now_is_refused(self, file, tmp_path):
        link, other = tmp_path / "link.yaml", tmp_path / "other.yaml"
        link.symlink_to(file)
        with serving(str(link)) as server:
            disk = post(server, "open", {})[1]["disk"]
            link.unlink()
            link.symlink_to(other)
            for force in (False, True):
                found = store(server, NEW, disk, force=force)
                assert "leads elsewhere now" in found["reason"]
        assert other.read_text(encoding="utf-8") == "other: 1\n"
        assert file.read_text(encoding="utf-8") == RIG

    def test_a_link_in_the_place_of_the_file_is_neither_read_nor_followed(self, server, file, tmp_path):
        other = tmp_path / "other.yaml"
        disk = post(server, "open", {})[1]["disk"]
        file.unlink()
        file.symlink_to(other)
        found = store(server, NEW, disk, force=True)
        assert found["stored"] is False
        assert "other: 1" not in json.dumps(found)
        assert store(server, NEW, found["disk"], force=True)["stored"] is False
        assert "other: 1" not in json.dumps(post(server, "changes", {"disk": disk}))
        assert other.read_text(encoding="utf-8") == "other: 1\n"
        assert file.is_symlink()

    def test_a_folder_that_becomes_a_link_is_refused(self, server, file, tmp_path):
        disk = post(server, "open", {})[1]["disk"]
        elsewhere = tmp_path / "elsewhere"
        file.parent.rename(elsewhere)
        file.parent.symlink_to(elsewhere)
        assert "leads elsewhere now" in store(server, NEW, disk)["reason"]
        assert (elsewhere / "rig.yaml").read_text(encoding="utf-8") == RIG

    @pytest.mark.parametrize("swap", ["link", "circle", "pipe", "folder"])
    def test_a_swap_in_the_last_moment_writes_nowhere_else(self, file, tmp_path, monkeypatch, swap):
        """The file is exchanged between the check and the replacement."""
        own, other = DiskFile(file), tmp_path / "other.yaml"
        disk = own.version().name
        begun = disk_file.atomic_replacement

        def swapped(path, **options):
            file.unlink()
            if swap == "link":
                file.symlink_to(other)
            elif swap == "circle":
                file.symlink_to(file)
            elif swap == "pipe":
                os.mkfifo(file)
            else:
                file.mkdir()
            return begun(path, **options)

        monkeypatch.setattr(disk_file, "atomic_replacement", swapped)
        assert own.store(NEW, disk).reason
        assert other.read_text(encoding="utf-8") == "other: 1\n"
        assert [one.name for one in file.parent.iterdir()] == ["rig.yaml"]

    def test_a_change_in_the_last_moment_is_kept(self, file, monkeypatch):
        own = DiskFile(file)
        disk, begun = own.version().name, disk_file.atomic_replacement

        def swapped(path, **options):
            file.write_text("newer: 1\n", encoding="utf-8")
            return begun(path, **options)

        monkeypatch.setattr(disk_file, "atomic_replacement", swapped)
        found = own.store(NEW, disk)
        assert "changed by another program" in found.reason
        assert found.disk.text == "newer: 1\n"
        assert file.read_text(encoding="utf-8") == "newer: 1\n"
        assert [one.name for one in file.parent.iterdir()] == ["rig.yaml"]


def test_of_two_writers_one_is_refused(server, file):
    """Both know the same version; only the first may replace it, again and again."""
    disk = post(server, "open", {})[1]["disk"]
    for turn in range(5):
        texts = [RIG.replace("400", str(1000 + 10 * turn + k)) for k in range(8)]
        with ThreadPoolExecutor(8) as pool:
            found = list(pool.map(lambda text, disk=disk: store(server, text, disk), texts))
        stored = [text for text, one in zip(texts, found, strict=True) if one["stored"]]
        assert len(stored) == 1
        assert file.read_text(encoding="utf-8") == stored[0]
        disk = next(one["disk"] for one in found if one["stored"])


def test_a_reader_never_sees_half_a_file(server, file):
    long = RIG + "# a line of a comment\n" * 20_000
    seen, stop = set(), threading.Event()

    def read():
        while not stop.is_set():
            seen.add(len(file.read_bytes()))

    reader = threading.Thread(target=read)
    reader.start()
    disk = post(server, "open", {})[1]["disk"]
    for k in range(10):
        disk = store(server, long if k % 2 == 0 else RIG, disk)["disk"]
    stop.set()
    reader.join(10)
    assert seen <= {len(RIG), len(long)}


class TestAttacks:
    @pytest.fixture(autouse=True)
    def untouched(self, file, tmp_path):
        yield
        assert file.read_text(encoding="utf-8") == RIG
        assert (tmp_path / "other.yaml").read_text(encoding="utf-8") == "other: 1\n"
        assert sorted(one.name for one in tmp_path.iterdir()) == ["models", "other.yaml"]
        assert [one.name for one in file.parent.iterdir()] == ["rig.yaml"]

    @pytest.mark.parametrize("entry", ["file", "path", "folder", "name", "path_shown"])
    @pytest.mark.parametrize("value", ["../other.yaml", "/etc/passwd", "new.yaml"])
    def test_no_request_names_a_file(self, server, entry, value):
        disk = post(server, "open", {})[1]["disk"]
        for question in ("store", "text", "open", "changes"):
            status, found = post(server, question, {"text": NEW, "disk": disk, "revision": 1, entry: value})
            assert status == 400
            assert "no entry of this" in found["error"]

    @pytest.mark.parametrize(
        "path", ["store/../store", "store/other.yaml", "../store", "store?file=x", "store%2f..", "STORE", "store/"]
    )
    def test_no_path_names_a_file(self, server, path):
        disk = post(server, "open", {})[1]["disk"]
        assert post(server, path, {"text": NEW, "disk": disk})[0] == 404

    @pytest.mark.parametrize(
        "headers",
        [
            {"Origin": "http://evil.example"},
            {"Origin": "null"},
            {"Origin": "https://127.0.0.1"},
            {"Host": "evil.example"},
            {"token": "guessed"},
        ],
    )
    def test_nobody_else_stores(self, server, headers):
        disk = post(server, "open", {})[1]["disk"]
        for question in ("store", "open", "text", "changes", "complete", "paste"):
            status, found = post(server, question, {"text": NEW, "disk": disk}, **headers)
            assert status == 403
            assert set(found) == {"error"}

    @pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data"])
    def test_a_form_stores_nothing(self, server, kind):
        disk = post(server, "open", {})[1]["disk"]
        assert post(server, "store", {"text": NEW, "disk": disk}, Content_Type=kind)[0] == 415

    @pytest.mark.parametrize("method", ["GET", "PUT", "DELETE", "OPTIONS"])
    def test_other_methods_store_nothing(self, server, method):
        connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
        connection.request(method, f"/{server.guard.token}/api/store", b"")
        assert connection.getresponse().status == (404 if method == "GET" else 405)
        connection.close()

    def test_sizes(self, server):
        disk = post(server, "open", {})[1]["disk"]
        large = "#" * MOST_BYTES
        status, found = post(server, "text", {"text": large, "revision": 1})
        assert (status, found["revision"]) == (200, 1)
        for text in (large + "#", "\u00e4" * (MOST_BYTES // 2 + 1)):
            assert post(server, "text", {"text": text, "revision": 2})[0] == 413
            assert post(server, "store", {"text": text, "disk": disk})[0] == 413
        assert post(server, "store", b"", Content_Length=str(LARGEST_TEXT_REQUEST + 1))[0] == 413
        assert post(server, "changes", b"", Content_Length=str(LARGEST_REQUEST + 1))[0] == 413

    @pytest.mark.parametrize(
        ("body", "said"),
        [
            (b'{"text": "a", "disk": "x", "disk": "y"}', "stands twice"),
            (b'{"document": "a", "document": "b"}', "stands twice"),
            (b"[" * 100_000, "no JSON text"),
            (b'{"text": ' * 50_000, "no JSON text"),
            (b'{"text": {"text": {}}, "disk": "x"}', "text is a text"),
            (b'{"text": "\\ud800", "disk": "x"}', "half of a character"),
            (b'{"text": "a", "disk": NaN}', "NaN"),
            (b'{"text": "a", "disk": null}', "disk is a text"),
            (b'{"document": "../../other", "text": "a", "disk": "x"}', "document is a name"),
            (b"\xff\xfe", "no JSON text"),
        ],
    )
    def test_what_is_no_request(self, server, body, said):
        status, found = post(server, "store", body)
        assert status == 400
        assert said in found["error"]

    def test_an_empty_version_is_none(self, server):
        for disk in ("", "0", GONE, "*", "rig.yaml"):
            assert store(server, NEW, disk, force=True)["stored"] is False


def test_every_start_page_has_a_nonce_of_its_own(server):
    seen = set()
    for path in ("", "index.html", ""):
        connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
        connection.request("GET", f"/{server.guard.token}/{path}")
        reply = connection.getresponse()
        policy, text = reply.headers["Content-Security-Policy"], reply.read().decode()
        connection.close()
        nonce = text.partition('<meta name="style-nonce" content="')[2].partition('"')[0]
        assert len(nonce) >= 20
        assert f"style-src 'self' 'nonce-{nonce}';" in policy
        assert "script-src 'self';" in policy
        seen.add(nonce)
    assert len(seen) == 3
