"""``torsionnet check --watch`` as a process, while its files are written, replaced and taken away."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner
from support.patience import PATIENCE

from torsionnet.app.cli.app import app

ROOT = Path(__file__).parents[2]
SOUND = """torsionnet: 1
name: motor and load
elements:
  motor: {type: inertia, node: a, inertia: 0.078 kg*m^2}
  shaft: {type: spring, nodes: [a, b], stiffness: 13.3 kN*m/rad}
  load:  {type: inertia, node: b, inertia: 2.6 kg*m^2}
"""
PARTS = """torsionnet: 1
parts:
  half:
    ports: [a]
    parameters: {J: 2 kg*m^2}
    elements:
      disc: {type: inertia, node: a, inertia: J}
"""
USING = SOUND.replace("elements:", "include: [halves.yaml]\nuse: {h: {part: half, at: {a: b}}}\nelements:")


class Watching:
    """A running check of some files, whose lines on both streams are read one after the other."""

    def __init__(self, folder, *models):
        # A run in the background of a shell ignores Ctrl-C, and its children do.
        heard = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"
        program = f"{heard}; from torsionnet.app.cli import main; sys.exit(main())"
        command = [sys.executable, "-u", "-c", program, "check", "--watch", *models]
        new_group = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP} if os.name == "nt" else {}
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8",
            env={**os.environ, "PYTHONPATH": str(ROOT)}, **new_group,
        )  # fmt: skip
        self.lines = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line.rstrip("\n"))

    def until(self, wanted):
        """Lines up to one that a pattern finds."""
        lines = []
        while not lines or not re.search(wanted, lines[-1]):
            lines.append(self.lines.get(timeout=PATIENCE))
        return lines

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def interrupted(self):
        """Exit code after Ctrl-C."""
        self.process.send_signal(signal.CTRL_BREAK_EVENT if os.name == "nt" else signal.SIGINT)
        return self.process.wait(PATIENCE)


def write(path, text):
    path.write_text(text, encoding="utf-8")


def test_each_change_is_checked_with_its_time_until_ctrl_c(tmp_path):
    model = tmp_path / "model.yaml"
    write(model, SOUND)
    with Watching(tmp_path, "model.yaml") as watching:
        first = watching.until("^model.yaml: ")
        assert re.fullmatch(r"\d\d:\d\d:\d\d", first[0])
        assert first[-1].startswith("model.yaml: no errors")

        write(model, SOUND.replace("kg*m^2", "N*m", 1))
        lines = watching.until("^model.yaml: ")
        assert re.fullmatch(r"\d\d:\d\d:\d\d", lines[0])
        assert re.search("4:44: error: .*wrong-unit", lines[1])
        assert lines[-1] == "model.yaml: 1 error"

        # as most editors save: a new file takes the place of the old one
        write(tmp_path / "model.yaml~", SOUND)
        (tmp_path / "model.yaml~").replace(model)
        assert watching.until("^model.yaml: ")[-1].startswith("model.yaml: no errors")

        model.unlink()
        assert "[missing-file]" in watching.until("error")[-1]
        write(model, SOUND.replace("stiffness", "stifness"))
        assert watching.until("^model.yaml: ")[-1].startswith("model.yaml: 1 error")
        assert watching.process.poll() is None
        assert os.name == "nt" or watching.interrupted() == 0


def test_a_file_that_a_model_includes_is_watched_too_also_before_it_is_there(tmp_path):
    write(tmp_path / "model.yaml", USING)
    write(tmp_path / "other.yaml", SOUND)
    with Watching(tmp_path, "model.yaml", "other.yaml") as watching:
        lines = watching.until("^other.yaml: ")
        assert any('there is no file "halves.yaml"' in line for line in lines)
        write(tmp_path / "halves.yaml", PARTS)
        assert any(line.startswith("model.yaml: no errors") for line in watching.until("^other.yaml: "))
        write(tmp_path / "halves.yaml", PARTS.replace("inertia: J", "inertia: 2 kg*m"))
        lines = watching.until("^other.yaml: ")
        assert any("halves.yaml:7:47: error" in line for line in lines)
        assert any(line.startswith("model.yaml: 1 error") for line in lines)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--json", "dmf_rig"], "--watch prints for a reader"),
        (["-"], "standard input"),
        (["no_such.yaml"], "no_such.yaml [missing-file]"),
    ],
)
def test_what_cannot_be_watched_is_refused(arguments, said):
    shown = CliRunner().invoke(app, ["check", "--watch", *arguments])
    assert shown.exit_code == 2
    assert said in shown.stderr
