"""What is said of several limits and in several configurations in the same words, said once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

FEW_NAMES = 3
"""Configurations that are named rather than those left."""


def gathered(said: Iterable[tuple[str, str, str]]) -> Iterator[tuple[list[str], list[str], str]]:
    """Equal texts once, from (what a text is about, the configuration, the text), in the order they come in.

    A text stands once for all that it says of the same configurations.

    Examples
    --------
    >>> said = [("tail", "wet", "weak"), ("tail", "dry", "weak"), ("film", "wet", "weak"), ("hub", "wet", "weak")]
    >>> list(gathered([*said, ("tail", "wet", "worn")]))
    [(['tail'], ['wet', 'dry'], 'weak'), (['film', 'hub'], ['wet'], 'weak'), (['tail'], ['wet'], 'worn')]
    """
    places: dict[str, dict[str, dict[str, None]]] = {}
    for about, configuration, text in said:
        places.setdefault(text, {}).setdefault(about, {})[configuration] = None
    for text, where in places.items():
        by_configurations: dict[frozenset[str], list[str]] = {}
        for about, names in where.items():
            by_configurations.setdefault(frozenset(names), []).append(about)
        for abouts in by_configurations.values():
            yield abouts, list(where[abouts[0]]), text


def concerned(names: Sequence[str], known: Sequence[str]) -> str:
    """Some of the known configurations in words, by what they have in common on their axes where that says which.

    Examples
    --------
    >>> known = [f"water={water},firing={fires}" for water in ("wet", "dry") for fires in ("normal", "misfire", "off")]
    >>> concerned([name for name in known if "normal" not in name], known)
    'firing=misfire or off'
    >>> concerned(known[1:], known), concerned(["misfire", "off"], ["normal", "misfire", "off"])
    ('all but water=wet,firing=normal', 'misfire, off')
    """
    rest = [name for name in known if name not in names]
    by_axes = _by_axes(names, known)
    if not by_axes and len(names) > FEW_NAMES and 0 < len(rest) < len(names):
        return f"all but {concerned(rest, known)}"
    return by_axes or ", ".join(names)


def _by_axes(names: Sequence[str], known: Sequence[str]) -> str:
    """The alternatives of axes that single out the names; empty where they do not, or where there are no axes."""
    if not all("=" in part for name in known for part in name.split(",")):
        return ""
    every = _alternatives(known)
    chosen = {axis: kept for axis, kept in _alternatives(names).items() if kept != every[axis]}
    held = [name for name in known if all(_choice(name).get(axis) in kept for axis, kept in chosen.items())]
    return ",".join(f"{axis}={' or '.join(kept)}" for axis, kept in chosen.items()) if set(held) == set(names) else ""


def _alternatives(names: Sequence[str]) -> dict[str, dict[str, None]]:
    """Alternatives by axis, each once, in the order of the names."""
    found: dict[str, dict[str, None]] = {}
    for axis, alternative in (pair for name in names for pair in _choice(name).items()):
        found.setdefault(axis, {})[alternative] = None
    return found


def _choice(name: str) -> dict[str, str]:
    pairs = (part.partition("=") for part in name.split(","))
    return {axis: alternative for axis, _, alternative in pairs}
