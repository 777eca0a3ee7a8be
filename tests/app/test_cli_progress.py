"""Progress of commands: shown in a terminal, and nowhere else."""

import contextlib
import io
import os
import sys
import threading

import pytest

import torsionnet as tn
from torsionnet.app.cli.app import run

pty = pytest.importorskip("pty", reason="a pseudo-terminal needs Linux or macOS")

COMMANDS = {
    "Holzer table": ["holzer", "two_stroke_ship", "--mode", "1"],
    "modes": ["modes", "dmf_rig", "-c", "all"],
}


def errors_in_a_terminal(arguments, monkeypatch):
    """Text that a command writes on stderr, where that is a terminal."""
    ours, theirs = pty.openpty()
    parts = []

    def read():
        with contextlib.suppress(OSError):  # Linux reports the closed other end as an error
            while part := os.read(ours, 65536):
                parts.append(part)

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    monkeypatch.setenv("TERM", "xterm")
    with os.fdopen(theirs, "w", encoding="utf-8") as terminal:
        monkeypatch.setattr(sys, "stderr", terminal)
        with contextlib.redirect_stdout(io.StringIO()):
            run(arguments)
        monkeypatch.undo()
    reader.join(5)
    return b"".join(parts).decode()


@pytest.mark.parametrize("words", ["modes", "Holzer table"])
def test_a_terminal_shows_what_is_calculated(words, monkeypatch):
    text = errors_in_a_terminal(COMMANDS[words], monkeypatch)
    assert "reading the model" in text
    assert words in text


@pytest.mark.parametrize("few", ["--lowest", "--up-to"])
def test_many_modes_point_to_the_lowest(few, monkeypatch, capsys):
    monkeypatch.setattr("torsionnet.linear.modes.natural_modes.MANY_COORDINATES", 2)
    run(COMMANDS["modes"])
    assert "all modes of 2 coordinates take a minute or more; the lowest N take seconds" in capsys.readouterr().err
    with pytest.warns(tn.TorsionnetWarning, match=r"lowest=N"):
        tn.load("dmf_rig").modes()
    run([*COMMANDS["modes"], few, "1"])
    assert "lowest" not in capsys.readouterr().err


def test_no_progress_without_a_terminal(capsys):
    run(COMMANDS["modes"])
    assert "reading the model" not in capsys.readouterr().err
