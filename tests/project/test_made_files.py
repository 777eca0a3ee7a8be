"""`make generate` makes anew what an edit of its inputs has changed, and leaves everything else."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parents[2] / "docs" / "made_files.py"
GENERATE = """
import subprocess, sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

def write(name, root):
    folder = root / "docs" / "generated"
    folder.mkdir(parents=True)
    if name == "units.md":
        import torsionnet.units
        text = f"{torsionnet.units.FACTOR}"
    elif name == "traps.md":
        text = (ROOT / "library" / "trap.yaml").read_text(encoding="utf-8")
    elif name == "report.md":
        text = " ".join(sorted(path.stem for path in (ROOT / "library").glob("*.yaml")))
    elif name == "layers.md":
        call = [sys.executable, "-c", "import torsionnet.units; print(torsionnet.units.FACTOR)"]
        text = subprocess.run(call, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    (folder / name).write_text(text, encoding="utf-8")
"""
NAMES = ("units.md", "traps.md", "report.md", "layers.md")


@pytest.fixture
def checkout(tmp_path):
    """A checkout whose files are made from a module, a model, the names of all models, and by another process."""
    for place, text in {
        "docs/generate.py": GENERATE,
        "torsionnet/__init__.py": "",
        "torsionnet/units.py": "FACTOR = 3\n",
        "torsionnet/other.py": "",
        "library/trap.yaml": "no",
    }.items():
        path = tmp_path / place
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    shutil.copy(PROGRAM, tmp_path / "docs")
    assert made(tmp_path) == {*NAMES}
    return tmp_path


def made(checkout, *more, code=0):
    """Names of the files that the program says it has written, or would."""
    done = subprocess.run(
        [sys.executable, "-B", checkout / "docs" / "made_files.py", *NAMES, *more],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (code, "")
    return {line.rpartition("/")[2] for line in done.stdout.splitlines()}


@pytest.mark.parametrize(
    ("place", "text", "changed"),
    [
        # Bytecode of the same second is told apart by its size alone.
        ("torsionnet/units.py", "FACTOR = 10\n", {"units.md", "layers.md"}),
        ("library/trap.yaml", "off", {"traps.md"}),
        ("library/another.yaml", "", {"report.md"}),
        ("docs/generated/units.md", "written by hand", {"units.md"}),
        ("torsionnet/other.py", "VALUE = 1\n", set()),
    ],
)
def test_an_edit_changes_what_was_made_from_it(checkout, place, text, changed):
    (checkout / place).write_text(text, encoding="utf-8")
    before = {name: (checkout / "docs" / "generated" / name).read_text(encoding="utf-8") for name in NAMES}
    assert made(checkout, "--check", code=int(bool(changed))) == changed
    assert before == {name: (checkout / "docs" / "generated" / name).read_text(encoding="utf-8") for name in NAMES}
    assert made(checkout) == changed
    assert made(checkout) == made(checkout, "--all") == set()


def test_a_check_without_a_record_compares_everything(checkout):
    shutil.rmtree(checkout / ".cache")
    assert made(checkout, "--check") == set()
    shutil.rmtree(checkout / ".cache")
    (checkout / "docs" / "generated" / "report.md").unlink()
    assert made(checkout, "--check", code=1) == {"report.md"}


def test_every_name_has_a_writer(monkeypatch):
    monkeypatch.syspath_prepend(PROGRAM.parent)
    import generate
    import made_files

    assert {*generate.PAGES, *generate.WRITERS} == {*made_files.IN_REPOSITORY, *made_files.FOR_PAGES}


EXAMPLE = """
import sys
sys.path[:0] = ["", "docs"]
import gallery_figures
gallery_figures.forget_stale()
if len(sys.argv) > 1:
    import torsionnet.units
    gallery_figures.record({}, "plot_units.py")
"""


def test_an_example_runs_again_where_what_it_imported_has_changed(checkout):
    pytest.importorskip("sphinx_gallery", reason="sphinx-gallery is in the group docs")
    shutil.copy(PROGRAM.with_name("gallery_figures.py"), checkout / "docs")
    ran = checkout / "docs" / "gallery" / "plot_units.py.md5"
    ran.parent.mkdir()

    def is_kept(*more):
        subprocess.run([sys.executable, "-B", "-c", EXAMPLE, *more], cwd=checkout, check=True)
        return ran.exists()

    ran.touch()
    assert not is_kept("run"), "nothing is known of when it ran"
    ran.touch()
    (checkout / "torsionnet" / "other.py").write_text("VALUE = 2\n", encoding="utf-8")
    assert is_kept()
    (checkout / "torsionnet" / "units.py").write_text("FACTOR = 5\n", encoding="utf-8")
    assert not is_kept()
