"""Clients that send a byte now and then, or none, do not keep the page from its user."""

import contextlib
import http.client
import json
import socket
import threading
import time

import pytest
from support.explore_pages import serving
from support.patience import PATIENCE, wait_for

from torsionnet.app.explore import api, connections, documents
from torsionnet.app.explore.connections import MOST_CONNECTIONS

CLIENTS = 40


@pytest.fixture
def server():
    with serving("dmf_rig") as found:
        yield found


def ask(server, path="", entries=None, meanwhile=lambda: None):
    """Status of one request on a connection of its own, 0 where it was cut off; something happens before its answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
    method, body = ("GET", None) if entries is None else ("POST", json.dumps(entries))
    try:
        connection.request(method, f"/{server.guard.token}/{path}", body, {"Content-Type": "application/json"})
        meanwhile()
        reply = connection.getresponse()
        reply.read()
        return reply.status
    except (ConnectionError, http.client.HTTPException):
        return 0
    finally:
        connection.close()


class Dripping:
    """Clients that send one byte after the other and come again when they are sent away."""

    def __init__(self, server, start):
        self.server, self.start = server, start.encode()
        self.connections = [self.connected() for _ in range(CLIENTS)]

    def connected(self):
        connection = socket.create_connection(self.server.server_address, timeout=PATIENCE)
        with contextlib.suppress(OSError):
            connection.sendall(self.start)
        return connection

    def drip(self):
        for k, connection in enumerate(self.connections):
            try:
                connection.send(b"G")
                connection.setblocking(False)
                with contextlib.suppress(BlockingIOError):
                    if not connection.recv(1000):
                        raise ConnectionResetError
            except OSError:
                connection.close()
                self.connections[k] = self.connected()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for connection in self.connections:
            connection.close()


def starts(server):
    host = f"Host: 127.0.0.1:{server.server_address[1]}\r\n"
    question = f"POST /{server.guard.token}/api/answer HTTP/1.1\r\n{host}Content-Type: application/json\r\n"
    return {
        "nothing": "",
        "line": "",
        "header": f"GET / HTTP/1.1\r\n{host}X: ",
        "body": f"{question}Content-Length: 5000\r\n\r\n{{",
    }


@pytest.mark.parametrize("where", ["header", "line", "body"])
def test_dripping_clients_do_not_keep_the_page(server, where):
    with Dripping(server, starts(server)[where]) as clients:
        for _ in range(10):
            clients.drip()
            assert ask(server, meanwhile=clients.drip) == 200
            assert ask(server, "api/answer", {"document": "tab"}, clients.drip) == 200


def test_silent_clients_give_up_their_places(server):
    silent = [socket.create_connection(server.server_address, timeout=PATIENCE) for _ in range(CLIENTS)]
    try:
        for _ in range(MOST_CONNECTIONS):
            assert ask(server) == 200
        assert len(server.places._places) <= MOST_CONNECTIONS
    finally:
        for connection in silent:
            connection.close()


def stages(server):
    return [place.stage for place in list(server.places._places.values())]


def test_a_waiting_connection_goes_before_a_request_that_comes_in(server, monkeypatch):
    monkeypatch.setattr(connections, "HEADER_SECONDS", PATIENCE)
    monkeypatch.setattr(connections, "IDLE_SECONDS", PATIENCE)
    kept = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
    kept.request("GET", f"/{server.guard.token}/")
    kept.getresponse().read()
    coming = [socket.create_connection(server.server_address, timeout=PATIENCE) for _ in range(MOST_CONNECTIONS - 1)]
    for connection in coming:
        connection.sendall(b"GET / HT")
    wait_for(lambda: stages(server).count(connections.HEADER) == len(coming))
    time.sleep(2 * connections.GRACE_SECONDS)
    assert ask(server) == 200
    assert kept.sock.recv(10) == b""
    kept.close()
    for connection in coming:
        connection.setblocking(False)
        with pytest.raises(BlockingIOError):
            connection.recv(10)
        connection.close()


def test_requests_that_are_answered_keep_their_places(server, monkeypatch):
    go_on, found = threading.Event(), []

    def slow(*_):
        go_on.wait(PATIENCE)
        return {"slow": True}

    monkeypatch.setitem(api.QUESTIONS, "api/answer", slow)
    entries = [{"document": f"tab-{k % 4}", "kind": f"pin-{k}"} for k in range(MOST_CONNECTIONS)]
    asking = [threading.Thread(target=lambda one=one: found.append(ask(server, "api/answer", one))) for one in entries]
    for one in asking:
        one.start()
    try:
        wait_for(lambda: stages(server).count(connections.ANSWER) == MOST_CONNECTIONS)
        with socket.create_connection(server.server_address, timeout=PATIENCE) as late:
            assert late.recv(1000).startswith(b"HTTP/1.1 503 ")
    finally:
        go_on.set()
        for one in asking:
            one.join(PATIENCE)
    assert found == [200] * MOST_CONNECTIONS
    assert ask(server) == 200


@pytest.mark.parametrize(("stage", "where"), [("HEADER", "header"), ("IDLE", "nothing"), ("REQUEST", "body")])
def test_each_part_of_a_request_has_time_as_a_whole(server, monkeypatch, stage, where):
    monkeypatch.setattr(connections, f"{stage}_SECONDS", 0.3)
    began = time.monotonic()
    with socket.create_connection(server.server_address, timeout=PATIENCE) as slow:
        slow.sendall(starts(server)[where].encode())
        slow.settimeout(0.05)
        closed = False
        while not closed and time.monotonic() - began < PATIENCE:
            if where != "nothing":
                with contextlib.suppress(OSError):
                    slow.send(b"G")
            try:
                closed = not slow.recv(1000)
            except TimeoutError:
                continue
            except OSError:
                closed = True
    assert closed
    assert time.monotonic() - began >= 0.3


def test_a_closed_tab_frees_its_place(tmp_path, monkeypatch):
    monkeypatch.setattr(documents, "POLL_SECONDS", 2 * PATIENCE)
    path = tmp_path / "rig.yaml"
    path.write_text("name: rig\n", encoding="utf-8")
    with serving(str(path)) as server:
        disk = server.documents.open("tab")["disk"]
        body = json.dumps({"document": "tab", "disk": disk}).encode()
        tab = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
        tab.request("POST", f"/{server.guard.token}/api/changes", body, {"Content-Type": "application/json"})
        wait_for(lambda: server.documents._polls == 1)
        tab.close()
        wait_for(lambda: not server.documents._polls and not server.places._places)


def test_waiting_for_changes_ends_with_the_server(tmp_path, monkeypatch):
    monkeypatch.setattr(documents, "POLL_SECONDS", 2 * PATIENCE)
    path = tmp_path / "rig.yaml"
    path.write_text("name: rig\n", encoding="utf-8")
    found = []
    with serving(str(path)) as server:
        disk = server.documents.open("tab")["disk"]
        entries = {"document": "tab", "disk": disk}
        tab = threading.Thread(target=lambda: found.append(ask(server, "api/changes", entries)))
        tab.start()
        wait_for(lambda: server.documents._polls == 1)
    tab.join(PATIENCE)
    assert found == [200]
