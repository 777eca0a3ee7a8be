"""Names in proportion to each other, kept as trees of the equations that tie them in pairs.

The ratio of two names is a product along the way between them and formed only where two names are compared. A chain of
n ratios thus costs n steps, and not n products of up to n factors each.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

LONGEST = 1024
"""Bits of numerator and denominator beyond which a ratio is long."""


def short_product(factor: Any, ratio: Any) -> Any:
    """The product while it is a short rational, else None."""
    product = None if ratio is None else factor * ratio
    return product if isinstance(product, Fraction) and max(_lengths(product)) <= LONGEST else None


def rounded_product(factor: Fraction, ratio: Fraction) -> Fraction:
    """The product; a long one is cut to half its bits, which leaves 500 of them right."""
    product = factor * ratio
    shorter = min(_lengths(product))
    if shorter <= LONGEST:
        return product
    cut = shorter - LONGEST // 2
    return Fraction(product.numerator >> cut, product.denominator >> cut)


def _lengths(ratio: Fraction) -> tuple[int, int]:
    return ratio.numerator.bit_length(), ratio.denominator.bit_length()


class ProportionSolution(NamedTuple):
    """What a name of a group amounts to: ``anchor`` = sum of ``row``, as equation ``number`` says.

    No two names of the row are in proportion. An empty row holds the group at zero.
    """

    anchor: Hashable
    row: dict[Any, Any]
    number: int


@dataclass(eq=False, slots=True)
class ProportionalGroup:
    """``size`` names in proportion; ``lead`` stands for them while there is no ``solution``.

    ``known`` are ratios to the root of the tree that have been worked out. A group that was joined to another one only
    leads to that.
    """

    lead: Hashable
    size: int = 1
    solution: ProportionSolution | None = None
    joined: ProportionalGroup | None = None
    known: dict[Hashable, Any] | None = None


class ProportionLink(NamedTuple):
    """``own`` * name + ``other`` * ``above`` = 0, equation ``number``."""

    above: Hashable
    own: Any
    other: Any
    number: int


class Proportions:
    """Groups of names; the links of a group make a tree."""

    def __init__(self) -> None:
        self._home: dict[Hashable, ProportionalGroup] = {}
        self._links: dict[Hashable, ProportionLink] = {}

    def copy(self) -> Proportions:
        """Groups that can be joined further without changing these."""
        new = Proportions()
        new._links = dict(self._links)
        again = {group: ProportionalGroup(group.lead, group.size, group.solution) for group in self.groups()}
        new._home = {name: again[self.group(name)] for name in self._home}
        return new

    def names(self) -> list[Hashable]:
        """Every name that stood in a row."""
        return list(self._home)

    def groups(self) -> list[ProportionalGroup]:
        """Every group once."""
        return [group for group in dict.fromkeys(self._home.values()) if group.joined is None]

    def group(self, name: Hashable) -> ProportionalGroup:
        """The group of a name; a name that was never tied is alone."""
        found = self._home.get(name)
        if found is None:
            found = self._home[name] = ProportionalGroup(name)
        elif found.joined is not None:
            while found.joined is not None:
                found = found.joined
            self._home[name] = found
        return found

    def join(self, name: Hashable, link: ProportionLink) -> None:
        """Tie a name to one of another group, whose lead stands for both groups from now on."""
        upper, lower = self.group(link.above), self.group(name)
        lead = upper.lead
        if lower.size > upper.size:
            # The smaller tree is turned and goes into the larger one: no name then moves more than log n times.
            upper, lower = lower, upper
            name, link = link.above, ProportionLink(name, link.other, link.own, link.number)
        self.turn(name)
        self._links[name] = link
        lower.joined = upper
        upper.size += lower.size
        upper.lead = lead

    def turn(self, name: Hashable) -> None:
        """Make a name the root of its tree."""
        link = self._links.pop(name, None)
        if link is not None:
            self.group(name).known = None
        while link is not None:
            above, own, other, number = link
            link = self._links.get(above)
            self._links[above] = ProportionLink(name, other, own, number)
            name = above

    def to_root(
        self, name: Hashable, known: dict[Hashable, Any], product: Callable[[Any, Any], Any] = operator.mul
    ) -> Any:
        """The ratio of a name to the root of its tree; ``known`` keeps that of every name on the way."""
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
            ratio = known[name] = product(-link.other / link.own, ratio)
        return ratio

    def ratio(self, first: Hashable, second: Hashable) -> Any:
        """Ratio of two different names of one group.

        That of their ratios to the root if these have few digits, else a product over the links between the two.
        """
        group = self.group(first)
        if group.known is None:
            group.known = {}
        over, under = (self.to_root(name, group.known, short_product) for name in (first, second))
        if over is not None and under is not None:
            return over / under
        up, down = self._ways(first, second)
        factors = [-link.other / link.own for link in up] + [-link.own / link.other for link in down]
        ratio = factors[0]
        for factor in factors[1:]:
            ratio = ratio * factor
        return ratio

    def between(self, first: Hashable, second: Hashable) -> list[int]:
        """Numbers of the equations between two names of one group."""
        return [link.number for way in self._ways(first, second) for link in way]

    def _ways(self, first: Hashable, second: Hashable) -> tuple[list[ProportionLink], list[ProportionLink]]:
        """Links from each of two names up to where they meet; the names climb in turns, so neighbours meet soon."""
        ways: tuple[list[ProportionLink], list[ProportionLink]] = ([], [])
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
