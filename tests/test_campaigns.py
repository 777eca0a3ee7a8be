"""Tests that a run without slow ones tries with fewer examples are known, whatever way they come to ask for them."""

import campaigns

HELPER = """
import campaigns

def host():
    return campaigns.quick

def other():
    return 1
"""
TESTS = """
from helper import host, other
import campaigns
import pytest

EXAMPLES = settings(max_examples=campaigns.examples(5, 25))

@EXAMPLES
def test_by_a_value(): ...

@pytest.mark.parametrize("seed", range(campaigns.examples(2, 9)))
def test_by_a_range(seed): ...

def test_by_a_helper():
    assert host()

@pytest.fixture
def many():
    return campaigns.examples(1, 2)

class TestOfAClass:
    def test_by_a_fixture(self, many): ...

def test_of_one_size():
    assert other()
"""


def test_each_way_is_seen(tmp_path, request):
    (tmp_path / "helper.py").write_text(HELPER)
    (tmp_path / "tests.py").write_text(TESTS)
    names = campaigns.sized(tmp_path / "tests.py")
    expected = {"test_by_a_value", "test_by_a_range", "test_by_a_helper", "TestOfAClass"}
    assert {name for name in names if name.lower().startswith("test")} == expected
    assert request.node.get_closest_marker("campaign")  # this one asks there, too
