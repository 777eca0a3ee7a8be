"""`make move` and the comparison of recorded outputs, on small trees of their own."""

import subprocess
import sys

import pytest
from structure.move import move, rewritten
from structure.outputs import run, same


def repository(root, files):
    """A git repository of these files, all of them known to it."""
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for command in (["init", "-q"], ["add", "-A"]):
        subprocess.run(["git", *command], cwd=root, check=True)


@pytest.fixture
def tree(tmp_path):
    repository(
        tmp_path,
        {
            "torsionnet/__init__.py": "",
            "torsionnet/solve/__init__.py": "",
            "torsionnet/solve/modes.py": "VALUE = 1\n",
            "torsionnet/solve/grid.py": "from torsionnet.solve import modes\n\nVALUE = modes.VALUE + 1\n",
            "torsionnet/solve/batch/__init__.py": "from torsionnet.solve.batch.walk import VALUE\n",
            "torsionnet/solve/batch/walk.py": "from torsionnet.solve.grid import VALUE\n",
            "torsionnet/solve/modes/__init__.py": '"""Modes."""\n',
            "tests/test_one.py": "from torsionnet.solve import batch, grid, modes as m\n\n\nSUM = batch.VALUE + grid.VALUE + m.VALUE\n",
            "docs/way.md": "`solve/modes.py`, `torsionnet.solve.modes.VALUE`, torsionnet/solve/batch, other/solve/modes.py\n",
        },
    )
    return tmp_path


def test_what_names_a_module_follows_it(tree):
    move([("solve/modes", "solve/modes/modes"), ("solve/batch", "solve/modes/batch")], tree)
    assert not (tree / "torsionnet/solve/modes.py").exists()
    assert not (tree / "torsionnet/solve/batch/walk.py").exists()
    code = "import sys; sys.path.insert(0, 'tests'); import test_one; print(test_one.SUM)"
    done = subprocess.run([sys.executable, "-c", code], cwd=tree, check=True, capture_output=True, text=True)
    assert done.stdout == "5\n"
    assert (tree / "docs/way.md").read_text("utf-8") == (
        "`solve/modes/modes.py`, `torsionnet.solve.modes.modes.VALUE`, torsionnet/solve/modes/batch, "
        "other/solve/modes.py\n"
    )


def test_names_that_only_begin_alike_stay():
    names = {"torsionnet.solve.modes": "torsionnet.solve.modes.modes"}
    text = "import torsionnet.solve.modes_over_speed\nfrom torsionnet.solve.modes import modes\n"
    assert rewritten(text, names, code=True) == text.replace("solve.modes import", "solve.modes.modes import")
    assert rewritten("x.torsionnet.solve.modes solve/modes_of.py", names, code=False).endswith(
        "modes solve/modes_of.py"
    )


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("solve/mode", "solve/modes/mode", "there is no torsionnet/solve/mode"),
        ("solve/modes", "solve/none/modes", "__init__.py first"),
        ("solve/modes", "solve/grid", "there is a torsionnet/solve/grid already"),
    ],
)
def test_a_move_that_cannot_be_changes_nothing(tree, old, new, why):
    with pytest.raises(SystemExit, match=why):
        move([(old, new)], tree)
    assert not subprocess.run(["git", "diff", "--quiet"], cwd=tree, check=False).returncode


def test_outputs_differ_where_a_command_says_something_else(tmp_path, capsys):
    before, after = tmp_path / "before", tmp_path / "after"
    for folder, name in ((before, "dmf_rig"), (after, "amt_rig")):
        folder.mkdir()
        (folder / "modes.txt").write_text(run([("modes", name)]).replace(name, "MODEL"), encoding="utf-8")
        (folder / "holzer.txt").write_text(run([("holzer", "geared_branch", "--csv", "a.csv")]), encoding="utf-8")
    assert same(before, before)
    assert not same(before, after)
    assert "== modes.txt" in (said := capsys.readouterr().out)
    assert "holzer" not in said
