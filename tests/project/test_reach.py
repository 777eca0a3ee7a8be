"""The map of what tests reach: how it is noted, what it answers, and which tests a change chooses from it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from reach import changed
from reach.changed import Change, chosen_tests, importing_files, places_of
from reach.numbers import numerical_places, without_numbers
from reach.reach_map import ReachMap, functions
from reach.recording import WITHOUT_NUMBERS

ROOT = Path(__file__).parents[2]
NOTES = {
    "tests/test_a.py::test_cheap": (0.1, False, ["torsionnet/linear/a.py:f", "torsionnet/base/b.py:B.g"]),
    "tests/test_a.py::test_dear": (3.0, False, ["torsionnet/linear/a.py:f"]),
    "tests/test_a.py::test_slow": (9.0, True, ["torsionnet/linear/a.py:f"]),
    "tests/test_b.py::test_text": (0.2, False, ["library/rig.yaml", "torsionnet/base/b.py:B.g"]),
}


@pytest.fixture
def reach():
    return ReachMap.of(NOTES)


def names(reach, place):
    return [reach.tests[number].partition("::")[2] for number in reach.reaching(place)]


def test_a_map_is_read_as_it_was_written(reach, tmp_path):
    reach.write(tmp_path / "map.npz")
    again = ReachMap.read(tmp_path / "map.npz")
    assert (again.tests, again.places, again.seconds.tolist()) == (reach.tests, reach.places, [0.1, 3.0, 9.0, 0.2])
    assert [names(again, place) for place in again.places] == [names(reach, place) for place in reach.places]


def test_without_a_map_make_reach_is_named(tmp_path):
    with pytest.raises(SystemExit, match="make reach"):
        ReachMap.read(tmp_path / "none.npz")


def test_tests_of_a_function_the_cheapest_first(reach):
    assert names(reach, "torsionnet/linear/a.py:f") == ["test_cheap", "test_dear", "test_slow"]
    assert names(reach, "library/rig.yaml") == ["test_text"]


def test_what_stands_outside_of_functions_counts_for_the_whole_file(reach):
    assert names(reach, "torsionnet/base/b.py:") == ["test_cheap", "test_text"]
    assert names(reach, "torsionnet/base/c.py:") == []


class TestNumbers:
    def test_functions_that_multiply_or_factor_matrices(self):
        text = "from scipy.linalg import eigh\n\ndef f(a):\n    return a @ a\n\ndef g(a):\n    return eigh(a)\n\ndef h(a):\n    return np.linalg.norm(a)\n\ndef k(a):\n    return np.abs(a)\n\ndef m(a):\n    return scipy.optimize.root(a)\n"
        assert numerical_places("a.py", text) == {"a.py:f", "a.py:g", "a.py:h", "a.py:m"}

    @pytest.mark.parametrize(
        ("numerical", "names"),
        [
            ("torsionnet/linear/a.py:f", ["tests/test_b.py"]),
            ("library/rig.yaml", ["tests/test_a.py"]),
            ("torsionnet/base/b.py:B.g", ["tests/test_a.py::test_dear", "tests/test_a.py::test_slow"]),
            ("torsionnet/base/c.py:f", ["tests/test_a.py", "tests/test_b.py"]),
        ],
    )
    def test_files_and_functions_that_reach_none_of_them(self, reach, numerical, names):
        assert without_numbers(reach, {numerical}) == names

    def test_most_of_what_is_left_out_is_there(self):
        """What has another name since leaves nothing out any more, until `make reach` writes the list anew."""
        files = {name.partition("::")[0] for name in WITHOUT_NUMBERS.read_text(encoding="utf-8").splitlines()}
        assert sum((ROOT / name).exists() for name in files) > max(30, 0.8 * len(files))


def test_names_of_functions_by_line():
    text = "A = 1\n\n\nclass B:\n    x: int = 1\n\n    @property\n    def f(self):\n        def g():\n            return 1\n        return g\n\nif A:\n    def h(): ...\n"
    assert {line: functions(text).get(line) for line in (1, 5, 7, 10, 14)} == {
        1: None,
        5: None,
        7: "B.f",
        10: "B.f",
        14: "h",
    }


class TestChange:
    def chosen(self, reach, seconds, *places):
        tests, number = chosen_tests(Change(set(places), set(), set()), reach, seconds)
        return [name.partition("::")[2] for name in tests], number

    def test_slow_tests_are_left_out(self, reach):
        assert self.chosen(reach, 100.0, "torsionnet/linear/a.py:f") == (["test_cheap", "test_dear"], 2)

    def test_every_file_has_a_turn_within_the_time(self, reach):
        places = ("torsionnet/linear/a.py:f", "torsionnet/base/b.py:B.g")
        # Half a second for each of both files, and 0.1 + 0.2 s: the dear one has no more time.
        assert self.chosen(reach, 1.4, *places) == (["test_cheap", "test_text"], 3)
        assert self.chosen(reach, 1.2, *places) == (["test_cheap"], 3)

    def test_functions_with_lines_that_are_new_or_gone(self, tmp_path, monkeypatch):
        monkeypatch.setattr(changed, "ROOT", tmp_path)
        module = tmp_path / "torsionnet" / "a.py"
        module.parent.mkdir()
        git = ["git", "-c", "user.name=a", "-c", "user.email=a@b.example", "-C", str(tmp_path)]
        module.write_text(
            "A = 1\n\n\ndef f():\n    return 1\n\n\ndef g():\n    return 2\n\n\ndef h():\n    return 3\n",
            encoding="utf-8",
        )
        for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "first"]):
            subprocess.run([*git, *words], check=True)
        module.write_text("A = 1\n\n\ndef f():\n    return 10\n\n\ndef h():\n    return 3\n", encoding="utf-8")
        assert places_of("torsionnet/a.py", "HEAD") == {"torsionnet/a.py:f", "torsionnet/a.py:g"}
        module.write_text(module.read_text(encoding="utf-8").replace("A = 1", "A = 2"), encoding="utf-8")
        assert "torsionnet/a.py:" in places_of("torsionnet/a.py", "HEAD")

    def test_files_of_tests_that_use_a_helper(self):
        assert "tests/project/test_mutation.py" in importing_files("tests/mutation/mutants.py")
        assert "tests/project/test_reach.py" in importing_files("tests/reach/recording.py")  # by way of reach_map
        assert importing_files("tests/project/test_reach.py") == {"tests/project/test_reach.py"}


NOTED = """
import subprocess, sys
import pytest
from torsionnet.base.units import Dimension

@pytest.fixture(scope="module")
def once():
    return Dimension() / Dimension()

def test_first(once): str(Dimension())
def test_second(once): ...
def test_child():
    subprocess.run([sys.executable, "-c", "from torsionnet.base.units import Dimension as D; D() * D()"], check=True)
def test_file(): open(ROOT + "/library/dmf_rig.yaml").close()
"""


@pytest.mark.slow
def test_calls_are_noted_by_test_with_those_of_fixtures_and_of_processes(tmp_path):
    file, written = tmp_path / "test_noted.py", tmp_path / "map.npz"
    file.write_text(f"ROOT = {str(ROOT)!r}\n{NOTED}", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}"}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "conftest",
        "-p",
        "no:cacheprovider",
        "--reach",
        str(written),
    ]
    subprocess.run([*command, "--rootdir", str(tmp_path), str(file)], cwd=tmp_path, env=environment, check=True)
    reach = ReachMap.read(written)
    units = "torsionnet/base/units.py:Dimension"
    assert sorted(names(reach, f"{units}.__str__")) == ["test_first"]
    # A new process divides and multiplies while it imports the table of units, too.
    assert sorted(names(reach, f"{units}.__truediv__")) == ["test_child", "test_first", "test_second"]
    assert sorted(names(reach, f"{units}.__mul__")) == ["test_child"]
    assert sorted(names(reach, "library/dmf_rig.yaml")) == ["test_file"]
