"""The server of the explore page answers its own page, and nobody else."""

import http.client
import json
import re
import socket
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from support.explore_pages import serving
from support.patience import PATIENCE

from torsionnet.app.explore import connections
from torsionnet.app.explore.api import LARGEST_REQUEST, QUESTIONS
from torsionnet.app.explore.connections import HEADERS


@pytest.fixture(scope="module")
def server():
    with serving("dmf_rig") as found:
        yield found


def ask(server, method="GET", path="", body=None, token=None, **headers):
    """Status, headers and body of one request; ``path`` stands behind the token."""
    port = server.server_address[1]
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    target = f"/{server.guard.token if token is None else token}/{path}"
    given = {"Content-Type": "application/json"} if body is not None else {}
    given |= {name.replace("_", "-"): value for name, value in headers.items() if value is not None}
    connection.putrequest(method, target, skip_host="Host" in given, skip_accept_encoding=True)
    if body is not None and "Content-Length" not in given and "Transfer-Encoding" not in given:
        given["Content-Length"] = str(len(body))
    for name, value in given.items():
        if name != "Content-Type" or value:
            connection.putheader(name, value)
    connection.endheaders(body)
    reply = connection.getresponse()
    content = reply.read()
    connection.close()
    return reply.status, dict(reply.getheaders()), content


def raw(server, text):
    """What comes back for bytes that no HTTP library would send."""
    with socket.create_connection(server.server_address, timeout=PATIENCE) as connection:
        connection.sendall(text.encode("latin-1"))
        connection.shutdown(socket.SHUT_WR)
        found = b""
        while piece := connection.recv(65536):
            found += piece
    return found.decode()


def own(server):
    return f"127.0.0.1:{server.server_address[1]}"


def test_it_listens_on_this_machine_only(server):
    assert server.server_address[0] == "127.0.0.1"
    assert server.address == f"http://{own(server)}/{server.guard.token}/"
    assert len(server.guard.token) >= 32


def test_every_server_has_a_token_of_its_own(server):
    with serving("dmf_rig") as other:
        assert other.guard.token != server.guard.token


@pytest.mark.parametrize("path", ["", "index.html", "main.js", "style.css", "vendor/uPlot.iife.min.js", "icon.svg"])
def test_files_of_the_page(server, path):
    status, headers, content = ask(server, path=path)
    assert status == 200
    assert content
    rule = "style-src 'self'"
    policy = re.sub(rf"{rule} 'nonce-[\w-]{{20,}}'", rule, headers["Content-Security-Policy"])
    assert {name: headers[name] for name in HEADERS} | {"Content-Security-Policy": policy} == HEADERS
    assert headers["Content-Type"].split(";")[0] in {"text/html", "text/javascript", "text/css", "image/svg+xml"}


def test_the_policy_allows_this_page_only(server):
    policy = ask(server)[1]["Content-Security-Policy"]
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == "'none'"
    assert rules["script-src"] == rules["connect-src"] == "'self'"
    assert "unsafe" not in policy
    assert "*" not in policy


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:80", "", "0.0.0.0:{port}"]
)
def test_foreign_host_is_refused(server, host):
    status, _, content = ask(server, Host=host.format(port=server.server_address[1]))
    assert status == 403
    assert b"not the address of the server" in content


def test_no_host_or_two_are_refused(server):
    line = f"GET /{server.guard.token}/ HTTP/1.1\r\n"
    assert raw(server, f"{line}\r\n").startswith("HTTP/1.1 403")
    assert raw(server, f"{line}Host: {own(server)}\r\nHost: evil.example\r\n\r\n").startswith("HTTP/1.1 403")


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://{host}", "http://127.0.0.1", ""])
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_foreign_origin_is_refused(server, method, origin):
    body = b"{}" if method == "POST" else None
    path = "api/answer" if method == "POST" else ""
    status, headers, content = ask(server, method, path, body, Origin=origin.format(host=own(server)))
    assert status == 403
    assert b"another web page" in content
    assert not any(name.startswith("Access-Control") for name in headers)


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_own_names_are_let_in(server, name):
    host = f"{name}:{server.server_address[1]}"
    assert ask(server, "POST", "api/answer", b"{}", Host=host, Origin=f"http://{host}")[0] == 200


@pytest.mark.parametrize("token", ["", "x", "api", "{token}x", "%20{token}"])
@pytest.mark.parametrize("path", ["", "main.js", "api/answer"])
def test_without_the_token_there_is_nothing(server, token, path):
    for method, body in (("GET", None), ("POST", b"{}")):
        status, _, content = ask(server, method, path, body, token=token.format(token=server.guard.token))
        assert status == 403
        assert server.guard.token.encode() not in content


@pytest.mark.parametrize(
    "path",
    [
        "../../server.py", "../__init__.py", "static/index.html", "vendor/", "vendor", "%2e%2e/server.py", "/etc/passwd",
        "..%2f..%2fserver.py", "....//server.py", "main.js/", "main.js?x", "main.js%00", "\\..\\server.py", "vendor/../main.js",
        "vendor/README.md", "api/answer", "api/",
    ],
)  # fmt: skip
def test_paths_outside_the_page_are_nowhere(server, path):
    assert ask(server, path=path)[0] == 404


def test_unknown_questions(server):
    assert ask(server, "POST", "api/shutdown", b"{}")[0] == 404
    assert ask(server, "POST", "main.js", b"{}")[0] == 404


@pytest.mark.parametrize("method", ["PUT", "DELETE", "PATCH", "OPTIONS", "HEAD", "TRACE", "FETCH"])
def test_other_methods(server, method):
    status, headers, _ = ask(server, method, "api/answer")
    assert status == 405
    assert headers["Allow"] == "GET, POST"


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "", "application/jsonp"])
def test_a_form_of_another_page_is_no_question(server, kind):
    assert ask(server, "POST", "api/answer", b"{}", Content_Type=kind)[0] == 415


def test_sizes(server):
    room = b'{"output": "theta_1"' + b" " * (LARGEST_REQUEST - 21) + b"}"
    assert len(room) == LARGEST_REQUEST
    assert ask(server, "POST", "api/answer", room)[0] == 200
    assert ask(server, "POST", "api/answer", b"", Content_Length=str(LARGEST_REQUEST + 1))[0] == 413
    assert ask(server, "POST", "api/answer", b"", Content_Length="9" * 5000)[0] == 413
    for length in ("-1", "x", "1e3", "\u00b2"):
        assert ask(server, "POST", "api/answer", b"", Content_Length=length)[0] == 411
    assert ask(server, "POST", "api/answer", b"", Transfer_Encoding="chunked")[0] == 411
    assert raw(server, f"GET /{'x' * 70_000} HTTP/1.1\r\n\r\n").startswith("HTTP/1.1 414")


def test_what_is_no_http(server):
    assert raw(server, "hello\r\n\r\n").startswith("HTTP/1.1 400")
    assert ask(server)[0] == 200


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"\xff", b'{"values": {"k_1": NaN}}', b"[" * 90_000])
def test_broken_questions(server, body):
    status, headers, content = ask(server, "POST", "api/answer", body)
    if body == b"":
        assert status == 200
        return
    assert status == 400
    assert headers["Content-Type"] == "application/json"
    assert set(json.loads(content)) == {"error"}
    assert b"Traceback" not in content


def test_a_bug_is_a_sentence_too(server, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError("a reason")

    monkeypatch.setitem(QUESTIONS, "api/answer", fail)
    status, _, content = ask(server, "POST", "api/answer", b"{}")
    assert status == 500
    assert json.loads(content)["error"].startswith("unexpected ZeroDivisionError ")
    assert ask(server)[0] == 200


def test_one_connection_serves_many_questions(server):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
    for value in (400, 500):
        body = json.dumps({"values": {"k_2": value}})
        connection.request("POST", f"/{server.guard.token}/api/answer", body, {"Content-Type": "application/json"})
        found = json.loads(connection.getresponse().read())
        assert next(one["si"] for one in found["parameters"] if one["name"] == "k_2") == value
    connection.close()


def test_many_at_once(server):
    def one(value):
        body = json.dumps({"document": f"tab-{value % 8}", "kind": f"pin-{value}", "values": {"k_2": value}})
        found = json.loads(ask(server, "POST", "api/answer", body.encode())[2])
        return next(one["si"] for one in found["parameters"] if one["name"] == "k_2")

    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(one, range(100, 124))) == list(range(100, 124))


def test_a_connection_that_breaks_off_is_no_event(server, capfd):
    with socket.create_connection(server.server_address, timeout=PATIENCE) as connection:
        connection.sendall(f"POST /{server.guard.token}/api/answer HTTP/1.1\r\nHost: {own(server)}\r\n".encode())
    assert ask(server)[0] == 200
    assert capfd.readouterr().err == ""


def test_two_requests_on_one_connection(server):
    """Each has its own time, and the second is read where the first has ended."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_address[1], timeout=PATIENCE)
    found = []
    for _ in range(2):
        connection.request("GET", f"/{server.guard.token}/style.css")
        reply = connection.getresponse()
        found.append((reply.status, reply.read()))
    connection.close()
    assert found[0] == found[1]
    assert found[0][0] == 200


HIDDEN = "GET /{token}/icon.svg HTTP/1.1\r\nHost: {host}\r\n\r\n"


@pytest.mark.parametrize(
    ("method", "lines"),
    [
        ("POST", "Content-Length: 2\r\nContent-Length: {length}\r\n"),
        ("POST", "Content-Length: {length}\r\nContent-Length: 2\r\n"),
        ("POST", "Content-Length: 2, {length}\r\n"),
        ("POST", "Content-Length: 2\r\nno colon\r\nContent-Length: {length}\r\n"),
        ("POST", "Content-Length: 2\r\nX: a\r\n Content-Length: {length}\r\n"),
        ("POST", "Content-Length: 2\r\nX: a\n Content-Length: {length}\r\n"),
        ("POST", "Content-Length: 2\r\nX: a\r Content-Length: {length}\r\n"),
        ("POST", "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n"),
        ("GET", "Content-Length: {length}\r\n"),
        ("GET", "Transfer-Encoding: chunked\r\n"),
    ],
)
def test_nothing_in_a_body_is_taken_for_a_request(server, method, lines):
    places = {"token": server.guard.token, "host": own(server)}
    hidden = HIDDEN.format(**places)
    path = "api/model" if method == "POST" else "style.css"
    head = (
        f"{method} /{server.guard.token}/{path} HTTP/1.1\r\nHost: {own(server)}\r\nContent-Type: application/json\r\n"
    )
    found = raw(server, head + lines.format(length=2 + len(hidden)) + "\r\n{}" + hidden)
    assert re.findall(r"HTTP/1.1 (\d+)", found) in (["400"], ["411"])
    assert "Connection: close" in found


def test_a_refusal_arrives_though_the_body_is_not_read(server, monkeypatch):
    """A connection that is closed with bytes left unread is reset, and what was sent on it is lost."""
    monkeypatch.setattr(connections, "PASSED_OVER_SECONDS", PATIENCE)
    head = f"POST /{server.guard.token}/api/model HTTP/1.1\r\nHost: {own(server)}\r\nContent-Type: text/plain\r\n"
    for _ in range(5):
        with socket.create_connection(server.server_address, timeout=PATIENCE) as connection:
            connection.sendall(f"{head}Content-Length: 90000\r\n\r\n".encode() + b" " * 30_000)
            time.sleep(0.1)
            connection.sendall(b" " * 60_000)
            found = b""
            while piece := connection.recv(65536):
                found += piece
        assert found.startswith(b"HTTP/1.1 415 ")
