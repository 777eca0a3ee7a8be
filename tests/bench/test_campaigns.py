"""Tests that most runs try with fewer examples than a campaign are known, whatever way they come to ask for them."""

from types import SimpleNamespace

import pytest
from support import campaigns

TESTS = """
from support.fmu_hosts import VERSIONS, Host
from support import campaigns
from support.campaigns import examples
import pytest

EXAMPLES = settings(max_examples=campaigns.examples(5, 25))

@EXAMPLES
def test_by_a_value(): ...

@pytest.mark.parametrize("seed", range(campaigns.examples(2, 9)))
def test_by_a_range(seed): ...

def test_by_a_function():
    assert examples(1, 2)

def test_by_a_helper():
    assert Host()

@pytest.fixture
def many():
    return campaigns.examples(1, 2)

class TestOfAClass:
    def test_by_a_fixture(self, many): ...

def test_of_one_size():
    assert VERSIONS
"""


def test_each_way_is_seen(tmp_path, request):
    (tmp_path / "tests.py").write_text(TESTS)
    names = campaigns.sized(tmp_path / "tests.py")
    expected = {"test_by_a_value", "test_by_a_range", "test_by_a_function", "test_by_a_helper", "TestOfAClass"}
    assert {name for name in names if name.lower().startswith("test")} == expected
    campaigns.mark_sized([request.node])
    assert request.node.get_closest_marker("campaign")  # this one asks there, too


class Case:
    """Stand-in for a case of a test, with what `leave_cases_out` asks of it."""

    def __init__(self, nodeid, **marks):
        self.nodeid, self.marks = nodeid, marks

    def get_closest_marker(self, name):
        return SimpleNamespace(args=self.marks[name]) if name in self.marks else None

    def add_marker(self, name):
        self.marks[name] = ()


def test_what_waits_for_the_night_is_slow():
    night, day = Case("a.py::test_night", nightly=()), Case("a.py::test_day", few=(1,))
    campaigns.leave_to_the_night([night, day])
    assert "slow" in night.marks
    assert "slow" not in day.marks


def test_cases_that_are_not_chosen_wait_for_the_night():
    first, second = campaigns.by_day(["dear", "cheap"], "cheap")
    assert [mark.name for mark in first.marks] == ["nightly"]
    assert second == "cheap"
    with pytest.raises(AssertionError):
        campaigns.by_day(["dear"], "renamed")


def test_only_campaigns_take_all(monkeypatch):
    monkeypatch.setattr(campaigns, "many", False)
    assert campaigns.examples(3, 40) == 3
    monkeypatch.setattr(campaigns, "many", True)
    assert campaigns.examples(3, 40) == 40


def test_of_many_cases_few_stay():
    many = [Case(f"a.py::test_many[{case}]", few=(3,)) for case in range(7)]
    long = [Case("a.py::test_many[long]", few=(3,), slow=())]
    fewer = [Case(f"b.py::test_many[{case}]", few=(3,)) for case in range(2)]
    others = [Case("a.py::test_one"), Case("a.py::test_all[0]")]
    campaigns.leave_cases_out([*long, *many, *fewer, *others])
    assert [case.nodeid[-2] for case in many if "slow" not in case.marks] == ["0", "3", "5"]
    assert not any("slow" in case.marks for case in fewer + others)


def test_of_each_test_as_many_cases_as_wanted():
    many = [Case(f"a.py::test_many[{case}]") for case in range(6)]
    kept, left_out = campaigns.most_of_each([Case("a.py::test_one"), *many, Case("b.py::test_many[0]")], 2)
    assert [case.nodeid for case in kept] == [
        "a.py::test_one",
        "a.py::test_many[0]",
        "a.py::test_many[3]",
        "b.py::test_many[0]",
    ]
    assert [case.nodeid[-2] for case in left_out] == ["1", "2", "4", "5"]


def test_of_many_slow_cases_some_wait_for_the_night():
    many = [Case(f"a.py::test_many[{case}]", few=(2, 3)) for case in range(9)]
    campaigns.leave_cases_out(many)
    by_day = [case for case in many if "nightly" not in case.marks]
    assert [case.nodeid[-2] for case in by_day if "slow" not in case.marks] == ["0", "5"]
    assert [case.nodeid[-2] for case in by_day if "slow" in case.marks] == ["1", "4", "7"]
    assert all("slow" in case.marks for case in many if "nightly" in case.marks)
