"""Entries of which one stands instead of another: what is wrong where several are given, or none."""

from __future__ import annotations

from torsionnet.core.errors import Fault

_COUNTS = {2: "two", 3: "three", 4: "four"}


def given(owner: object, *names: str) -> list[str]:
    """Which of some entries have a value, in their order."""
    values = ((name, getattr(owner, name)) for name in names)
    return [name for name, value in values if value is not None and value not in ((), {})]


def one_at_most(owner: object, *names: str, of: str = "") -> list[Fault]:
    """The fault that two of some entries are given, at the second; ``of`` says what they are of, as "the damping"."""
    found = given(owner, *names)
    if len(found) < 2:
        return []
    text = f"{of} is given by {found[0]} or by {found[1]}" if of else f"give {found[0]} or {found[1]}"
    return [Fault(f"{text}, not both", (found[1],), on_key=True)]


def one_exactly(owner: object, *names: str, of: str = "", form: str = "") -> list[Fault]:
    """The fault that not exactly one of some entries is given; ``form`` shows how, where none of them is."""
    if given(owner, *names):
        return one_at_most(owner, *names, of=of)
    wanted = f"{', '.join(names[:-1])} or {names[-1]}, one of the {_COUNTS[len(names)]}"
    text = f"{of} is given by {wanted}" if of else f"give {wanted}"
    return [Fault(f"{text}: {form}" if form else text, on_key=True)]
