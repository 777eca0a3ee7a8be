"""Entries of which one stands instead of another have one wording, and the place of the one too many."""

from dataclasses import dataclass

import pytest

from torsionnet.base.entries.composite import given_entries, one_at_most, one_exactly


@dataclass
class Entries:
    a: object = None
    b: object = None
    c: object = ()


@pytest.mark.parametrize(
    ("entries", "at_most", "exactly"),
    [
        (Entries(), None, ("missing-entry", ())),
        (Entries(b=0), None, None),
        (Entries(c=(1,)), None, None),
        (Entries(a=1, c=(1,)), ("contradicting-entries", ("c",)), ("contradicting-entries", ("c",))),
        (Entries(1, 2, {}), ("contradicting-entries", ("b",)), ("contradicting-entries", ("b",))),
    ],
)
def test_what_is_said_and_where(entries, at_most, exactly):
    for question, wanted in ((one_at_most, at_most), (one_exactly, exactly)):
        found = [(fault.kind, fault.path) for fault in question(entries, "a", "b", "c")]
        assert found == ([] if wanted is None else [wanted])
        assert all(fault.on_key for fault in question(entries, "a", "b", "c"))


def test_the_sentence_names_what_it_is_about_and_shows_the_form():
    (both,) = one_exactly(Entries(1, 2), "a", "b", of="the film", form="{a: 1}")
    assert both.message == "the film is given by a or by b, not both"
    (none,) = one_exactly(Entries(), "a", "b", of="the film", form="{a: 1}")
    assert none.message == "the film is given by a or b, one of the two: {a: 1}"
    assert given_entries(Entries(0, None, (1,)), "c", "b", "a") == ["c", "a"]
