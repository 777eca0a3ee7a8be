"""Names in proportion to each other, kept as trees of the equations that tie them in pairs.

The ratio of two names is a product along the way between them and formed only where two names are compared. A chain of
n ratios thus costs n steps, and not n products of up to n factors each.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, NamedTuple


class Solution(NamedTuple):
    """What a name of a group amounts to: ``anchor`` = sum of ``row``, as equation ``number`` says.

    No two names of the row are in proportion. An empty row holds the group at zero.
    """

    anchor: Hashable
    row: dict[Any, Any]
    number: int


@dataclass(eq=False, slots=True)
class Group:
    """``size`` names in proportion; ``lead`` stands for them while there is no ``solution``.

    A group that was joined to another one only leads to that.
    """

    lead: Hashable
    size: int = 1
    solution: Solution | None = None
    joined: Group | None = None


class Link(NamedTuple):
    """``own`` * name + ``other`` * ``above`` = 0, equation ``number``."""

    above: Hashable
    own: Any
    other: Any
    number: int


class Proportions:
    """Groups of names; the links of a group make a tree."""

    def __init__(self) -> None:
        self._home: dict[Hashable, Group] = {}
        self._links: dict[Hashable, Link] = {}

    def copy(self) -> Proportions:
        """Groups that can be joined further without changing these."""
        new = Proportions()
        new._links = dict(self._links)
        again = {group: Group(group.lead, group.size, group.solution) for group in self.groups()}
        new._home = {name: again[self.group(name)] for name in self._home}
        return new

    def names(self) -> list[Hashable]:
        """Every name that stood in a row."""
        return list(self._home)

    def groups(self) -> list[Group]:
        """Every group once."""
        return [group for group in dict.fromkeys(self._home.values()) if group.joined is None]

    def group(self, name: Hashable) -> Group:
        """The group of a name; a name that was never tied is alone."""
        found = self._home.get(name)
        if found is None:
            found = self._home[name] = Group(name)
        elif found.joined is not None:
            while found.joined is not None:
                found = found.joined
            self._home[name] = found
        return found

    def join(self, name: Hashable, link: Link) -> None:
        """Tie a name to one of another group, whose lead stands for both groups from now on."""
        upper, lower = self.group(link.above), self.group(name)
        lead = upper.lead
        if lower.size > upper.size:
            # The smaller tree is turned and goes into the larger one: no name then moves more than log n times.
            upper, lower = lower, upper
            name, link = link.above, Link(name, link.other, link.own, link.number)
        self.turn(name)
        self._links[name] = link
        lower.joined = upper
        upper.size += lower.size
        upper.lead = lead

    def turn(self, name: Hashable) -> None:
        """Make a name the root of its tree."""
        link = self._links.pop(name, None)
        while link is not None:
            above, own, other, number = link
            link = self._links.get(above)
            self._links[above] = Link(name, other, own, number)
            name = above

    def to_root(self, name: Hashable, known: dict[Hashable, Any], rounded: Callable[[Any], Any] | None = None) -> Any:
        """The ratio of a name to the root of its tree; ``known`` keeps all ratios on the way, each of them rounded."""
        way = []
        while name not in known:
            link = self._links.get(name)
            if link is None:
                known[name] = 1
            else:
                way.append((name, link))
                name = link.above
        ratio = known[name]
        for name, link in reversed(way):
            ratio = -link.other / link.own * ratio
            ratio = known[name] = rounded(ratio) if rounded else ratio
        return ratio

    def ratio(self, first: Hashable, second: Hashable) -> Any:
        """Ratio of two names of one group, by the links between them alone."""
        if first == second:
            return 1
        up, down = self._ways(first, second)
        factors = [-link.other / link.own for link in up] + [-link.own / link.other for link in down]
        ratio = factors[0]
        for factor in factors[1:]:
            ratio = ratio * factor
        return ratio

    def between(self, first: Hashable, second: Hashable) -> list[int]:
        """Numbers of the equations between two names of one group."""
        return [link.number for way in self._ways(first, second) for link in way]

    def _ways(self, first: Hashable, second: Hashable) -> tuple[list[Link], list[Link]]:
        """Links from each of two names up to where they meet; the names climb in turns, so neighbours meet soon."""
        ways: tuple[list[Link], list[Link]] = ([], [])
        passed = ({first: 0}, {second: 0})
        names = [first, second]
        side = 0
        while names[side] not in passed[1 - side]:
            link = self._links.get(names[side])
            if link is not None:
                ways[side].append(link)
                names[side] = link.above
                passed[side][link.above] = len(ways[side])
            side = 1 - side
        meeting = names[side]
        return ways[0][: passed[0][meeting]], ways[1][: passed[1][meeting]]
