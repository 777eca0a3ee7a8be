"""Results that are kept for a while: by key and type, within a number and a size."""

from __future__ import annotations

import pytest

from torsionnet.base import registers
from torsionnet.base.registers import RecentResults


@pytest.mark.parametrize(("number", "room"), [(2, 100), (10, 8)])
def test_what_was_not_asked_for_longest_goes_first(monkeypatch, number, room):
    monkeypatch.setattr(registers, "RECENT_RESULTS", number)
    monkeypatch.setattr(registers, "RECENT_BYTES", room)
    recent, made = RecentResults(), []

    def ask(key):
        recent.once(str, key, lambda: made.append(key) or "four", len)

    for key in "abacab":
        ask(key)
    assert "".join(made) == "abcb"


def test_what_is_larger_than_all_room_is_not_kept_and_drives_nothing_out(monkeypatch):
    monkeypatch.setattr(registers, "RECENT_BYTES", 8)
    recent, made = RecentResults(), []

    def ask(text):
        return recent.once(str, text, lambda: made.append(text) or text, len)

    for text in ("one", "far too long", "one", "far too long"):
        assert ask(text) == text
    assert made == ["one", "far too long", "far too long"]
