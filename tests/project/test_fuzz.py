"""Failures that fuzzing found, or that were reported, once more; and the fuzzing itself for a moment."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="limits of time and memory are those of POSIX")

from fuzz import sources, trying
from fuzz.kinds import KINDS, Kind

TESTS = Path(__file__).parents[1]
CORPUS = sorted(path for path in (TESTS / "fuzz" / "corpus").glob("*/*") if path.is_file())
LONG = "x" * 100_000


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("fuzz")
    sources.furnish(made)
    return made


def kind_of(path):
    name = path.parent.name
    return KINDS.get(name) or KINDS.get(f"{name}{path.suffix}")


def tried(kind, content, folder):
    path = folder / f"input{kind.ending}"
    path.write_bytes(content)
    return trying.attempt(kind, path)


@pytest.mark.few(5)
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_once_failed(path, folder):
    kind = kind_of(path)
    if kind is None:
        pytest.skip(f"the library for {path.suffix} is not installed")
    trial = tried(kind, path.read_bytes(), folder)
    if trial.signature.startswith("slow"):  # modules are loaded the first time
        trial = tried(kind, path.read_bytes(), folder)
    assert trial.outcome in {"result", "error"}, trial.signature


@pytest.mark.few(1, 13)
@pytest.mark.parametrize("kind", KINDS.values(), ids=list(KINDS))
def test_what_is_damaged_was_sound(kind, folder):
    path = folder / f"input{kind.ending}"
    path.write_bytes(kind.sound(folder))
    kind.use(path)


@pytest.mark.parametrize("where", ["name: disc", "  wheel:", "node: b", "J: 0.1", "soft:"])
def test_names_of_100_000_characters(where, folder):
    trial = tried(KINDS["model"], sources.RIG.replace(where, f"{where[:2]}{LONG}{where[2:]}").encode(), folder)
    assert trial.outcome in {"result", "error"}, trial.signature


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("use", "signature"),
    [
        (lambda _: {}["x"], "KeyError at no frame of the package"),
        (lambda _: (_ for _ in ()).throw(MemoryError), "MemoryError at"),
        (lambda path: sources.tn.load(path, 3), "TypeError at"),
        (lambda _: bytearray(110_000_000).find(b"x"), "more than 0.1 GB"),
        (lambda _: sum(range(20_000_000)), "slow in a library"),
    ],
)
def test_failures_are_seen(use, signature, folder, monkeypatch):
    monkeypatch.setattr(trying, "MOST_MEMORY", 1e8)
    trial = tried(Kind("test", ".yaml", lambda *_: b"", use, seconds=0.1 if "slow" in signature else 60.0), b"", folder)
    assert trial.outcome == "failure"
    assert signature in trial.signature


@pytest.mark.slow
def test_command(tmp_path):
    """Two kinds for a few seconds: counts, and an end that tells whether anything failed."""
    command = [sys.executable, "-m", "fuzz", "--seconds", "1", "--kind", "expression", "--kind", "record.npz"]
    ran = subprocess.run([*command, "--keep", str(tmp_path)], cwd=TESTS, capture_output=True, text=True, check=False)
    lines = {line.split()[0]: line.split()[1:] for line in ran.stdout.splitlines() if line}
    assert ran.returncode in {0, 1}, ran.stderr
    assert min(int(lines[name][0]) for name in ("expression", "record.npz")) > 0
    assert int(lines["all"][0]) == sum(int(lines[name][0]) for name in ("expression", "record.npz"))
