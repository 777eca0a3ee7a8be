"""Checks that one of several alternative entries of an object is given, and not more."""

from __future__ import annotations

from torsionnet.core.errors import Fault

_COUNTS = {2: "two", 3: "three", 4: "four"}


def given_entries(owner: object, *names: str) -> list[str]:
    """Names of those entries, out of the ones asked about, that have a value."""
    values = ((name, getattr(owner, name)) for name in names)
    return [name for name, value in values if value is not None and value not in ((), {})]


def one_at_most(owner: object, *names: str, of: str = "") -> list[Fault]:
    """Faults, placed at the second one given, where more than one of the alternative entries has a value.

    ``of`` says of what, as "the damping".
    """
    found = given_entries(owner, *names)
    if len(found) < 2:
        return []
    text = f"{of} is given by {found[0]} or by {found[1]}" if of else f"give {found[0]} or {found[1]}"
    return [Fault(f"{text}, not both", (found[1],), on_key=True)]


def one_exactly(owner: object, *names: str, of: str = "", form: str = "") -> list[Fault]:
    """Faults of an object that does not give exactly one of several alternative entries.

    ``form`` is an example of one.
    """
    if given_entries(owner, *names):
        return one_at_most(owner, *names, of=of)
    wanted = f"{', '.join(names[:-1])} or {names[-1]}, one of the {_COUNTS[len(names)]}"
    text = f"{of} is given by {wanted}" if of else f"give {wanted}"
    return [Fault(f"{text}: {form}" if form else text, on_key=True)]
