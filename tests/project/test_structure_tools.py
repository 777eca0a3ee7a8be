"""`make move`, `make join` and the comparison of recorded outputs, on small trees of their own."""

import subprocess
import sys

import pytest
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
            "torsionnet/first/__init__.py": "",
            "torsionnet/first/modes.py": "VALUE = 1\n",
            "torsionnet/first/grid.py": "from torsionnet.first import modes\n\nVALUE = modes.VALUE + 1\n",
            "torsionnet/first/batch/__init__.py": "from torsionnet.first.batch.walk import VALUE\n",
            "torsionnet/first/batch/walk.py": "from torsionnet.first.grid import VALUE\n",
            "torsionnet/first/modes/__init__.py": '"""Modes."""\n',
            "torsionnet/plot/__init__.py": "from torsionnet.plot.bode import bode\n",
            "torsionnet/plot/bode.py": "def bode():\n    return 4\n",
            "torsionnet/plot/charts/__init__.py": "",
            "tests/test_one.py": "from torsionnet.plot import bode\nfrom torsionnet.first import batch, grid, modes as m\n"
            "\nSUM = batch.VALUE + grid.VALUE + m.VALUE + bode()\n",
            "docs/way.md": "`first/modes.py`, `torsionnet.first.modes.VALUE`, torsionnet/first/batch, other/first/modes.py\n",
            "docs/reference.md": "torsionnet.plot.bode draws; torsionnet.plot.bode.DASHES\n",
        },
    )
    return tmp_path


def test_what_names_a_module_follows_it(tree):
    from structure.move import move

    move(
        [("first/modes", "first/modes/modes"), ("first/batch", "first/modes/batch"), ("plot/bode", "plot/charts/bode")],
        tree,
    )
    assert not (tree / "torsionnet/first/modes.py").exists()
    assert not (tree / "torsionnet/first/batch/walk.py").exists()
    code = "import sys; sys.path.insert(0, 'tests'); import test_one; print(test_one.SUM)"
    done = subprocess.run([sys.executable, "-c", code], cwd=tree, check=True, capture_output=True, text=True)
    assert done.stdout == "9\n"
    assert (tree / "docs/way.md").read_text("utf-8") == (
        "`first/modes/modes.py`, `torsionnet.first.modes.modes.VALUE`, torsionnet/first/modes/batch, "
        "other/first/modes.py\n"
    )

    assert (tree / "docs/reference.md").read_text("utf-8") == (
        "torsionnet.plot.bode draws; torsionnet.plot.charts.bode.DASHES\n"
    )


def test_names_that_only_begin_alike_stay():
    from structure.move import rewritten

    names = {"torsionnet.first.modes": "torsionnet.first.modes.modes"}
    text = "import torsionnet.first.modes_over_speed\nfrom torsionnet.first.modes import modes\n"
    assert rewritten(text, names, code=True) == text.replace("first.modes import", "first.modes.modes import")
    assert rewritten("x.torsionnet.first.modes first/modes_of.py", names, code=False).endswith(
        "modes first/modes_of.py"
    )


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("first/mode", "first/modes/mode", "there is no torsionnet/first/mode"),
        ("first/modes", "first/none/modes", "__init__.py first"),
        ("first/modes", "first/grid", "there is a torsionnet/first/grid already"),
    ],
)
def test_a_move_that_cannot_be_changes_nothing(tree, old, new, why):
    from structure.move import move

    with pytest.raises(SystemExit, match=why):
        move([(old, new)], tree)
    assert not subprocess.run(["git", "diff", "--quiet"], cwd=tree, check=False).returncode


@pytest.fixture
def pair(tmp_path):
    repository(
        tmp_path,
        {
            "torsionnet/__init__.py": "",
            "torsionnet/gears/__init__.py": "",
            "torsionnet/gears/teeth.py": '"""Teeth."""\n\nfrom __future__ import annotations\n\nimport math\n'
            "from typing import TYPE_CHECKING\n\nfrom torsionnet.gears.sizes import SIZES\n\nif TYPE_CHECKING:\n"
            "    from fractions import Fraction\n\nSHARE = 0.5\n\n\n# Half a tooth.\nclass Tooth:\n"
            '    """One tooth.\n\n    >>> Tooth().angle\n    90.0\n    """\n\n    angle = math.degrees(math.pi * SHARE)\n\n\n'
            "def turned(tooth: Tooth) -> Fraction | float:\n"
            '    """An angle.\n\n    >>> turned(Tooth())\n    91.0\n    """\n    return tooth.angle + SIZES\n',
            "torsionnet/gears/gear.py": '"""Gears."""\n\nimport math\n\nfrom torsionnet.gears.teeth import Tooth, turned\n\n'
            "KINDS = math.e\n\n\nclass Helical(Tooth):\n    wide = True\n\n\ndef angle():\n    return turned(Helical())\n",
            "torsionnet/gears/sizes.py": "SIZES = 1\n",
            "torsionnet/gears/late.py": "SIZES = 2\n",
            "torsionnet/gears/kinds.py": "import torsionnet.gears.angles as angles\n"
            "from torsionnet.gears.gear import KINDS\n\n\ndef f():\n"
            "    from torsionnet.gears.late import SIZES\n\n    return KINDS + SIZES + angles.whole()\n",
            "torsionnet/gears/angles.py": "TURN = 360\n\n\ndef whole():\n    return TURN\n",
            "torsionnet/gears/other.py": "KINDS = 3\nfrom torsionnet.gears import names\n\nLETTER = names.NAME\n",
            "torsionnet/gears/names.py": "KINDS = 4\nNAME = 'x'\n",
            "tests/test_two.py": "from torsionnet.gears import gear, teeth\nfrom torsionnet.gears.teeth import Tooth\n"
            "\nSUM = teeth.Tooth().angle + gear.angle() + Tooth.angle\n",
            "docs/way.md": "`gears/teeth.py`\n",
        },
    )
    return tmp_path


def planned(text, root):
    from structure.join import join, read_plan

    return join(read_plan(text), root)


def test_joined_modules_stand_in_the_order_of_their_imports(pair):
    assert not planned("@gears\nwheel = gear teeth sizes | Wheels.", pair)
    assert not (pair / "torsionnet/gears/teeth.py").exists()
    text = (pair / "torsionnet/gears/wheel.py").read_text("utf-8")
    assert text.startswith('"""Wheels."""\n\nfrom __future__ import annotations\n')
    kept = [
        "import math",
        "SIZES = 1",
        "# Teeth.",
        "SHARE = 0.5",
        "class Tooth:",
        "# Gears.",
        "KINDS = math.e",
        "class Helical(Tooth):",
    ]
    places = [text.index(part) for part in kept]
    assert places == sorted(places)
    assert "if TYPE_CHECKING:\n    from fractions import Fraction\n" in text
    assert "torsionnet.gears" not in text
    code = "import sys; sys.path.insert(0, 'tests'); import test_two; print(test_two.SUM)"
    done = subprocess.run([sys.executable, "-c", code], cwd=pair, check=True, capture_output=True, text=True)
    assert done.stdout == "271.0\n"
    assert (pair / "docs/way.md").read_text("utf-8") == "`gears/wheel.py`\n"


def test_what_functions_import_from_their_own_file_is_there(pair):
    assert not planned("@gears\nkinds = kinds late", pair)
    text = (pair / "torsionnet/gears/kinds.py").read_text("utf-8")
    assert "def f():\n\n    return KINDS + SIZES + angles.whole()" in text


def test_a_helper_that_two_members_have_stays_once_and_another_of_its_name_gets_a_name(tmp_path):
    helper = "def _half(x):\n    return x / 2\n"
    repository(
        tmp_path,
        {
            "torsionnet/__init__.py": "",
            "torsionnet/first.py": f'"""First."""\n\n{helper}\n\ndef quarter(x):\n    return _half(_half(x))\n',
            "torsionnet/second.py": f'"""Second."""\n\n{helper}\n\ndef eighth(x):\n    return _half(x) / 4\n',
            "torsionnet/third.py": '"""Third."""\n\ndef _half(x):\n    return x // 2\n\n\ndef floor(x):\n    return _half(x)\n',
        },
    )
    assert not planned("first = first second third", tmp_path)
    text = (tmp_path / "torsionnet/first.py").read_text("utf-8")
    assert text.count("def _half(x):\n    return x / 2\n") == 1
    names = {}
    exec(compile(text, "first", "exec"), names)
    assert (names["quarter"](4), names["eighth"](8), names["floor"](5)) == (1.0, 1.0, 2)


@pytest.mark.parametrize(
    ("plan", "why"),
    [
        ("names = names other", "KINDS is two things, in names and other"),
        ("sizes = sizes gear", "a circle of imports: torsionnet.gears.sizes, torsionnet.gears.teeth"),
        ("gear = gear none", "torsionnet.gears.gear: there is no torsionnet.gears.none"),
        ("names = sizes gear", "there is such a file already"),
    ],
)
def test_a_join_that_cannot_be_changes_nothing(pair, plan, why):
    assert why in "\n".join(planned(f"@gears\n{plan}", pair))
    assert not subprocess.run(["git", "diff", "--quiet"], cwd=pair, check=False).returncode


@pytest.mark.slow
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
