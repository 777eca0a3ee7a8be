"""Names in proportion to each other, kept as trees of the equations that tie them in pairs.

The ratio of two names is a product along the way between them and formed only where two names are compared. A chain of
n ratios thus costs n steps, and not n products of up to n factors each.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple

LONG_RATIO_BITS = 1024
"""Largest number of bits in exact ratios that are multiplied, as products would grow without end."""


def short_product(factor: Any, ratio: Any) -> Any:
    """Product of two ratios while it is a short rational, else None."""
    product = None if ratio is None else factor * ratio
    return product if isinstance(product, Fraction) and max(_lengths(product)) <= LONG_RATIO_BITS else None


def rounded_product(factor: Fraction, ratio: Fraction) -> Fraction:
    """Product of two exact ratios, with so few bits that further products stay short.

    A long product is rounded to half the bits, of which 500 are right.
    """
    product = factor * ratio
    shorter = min(_lengths(product))
    if shorter <= LONG_RATIO_BITS:
        return product
    # Both parts lose the same low bits, so that the ratio keeps its leading ones.
    cut = shorter - LONG_RATIO_BITS // 2
    return Fraction(product.numerator >> cut, product.denominator >> cut)


def _lengths(ratio: Fraction) -> tuple[int, int]:
    return ratio.numerator.bit_length(), ratio.denominator.bit_length()


class ProportionSolution(NamedTuple):
    """Solution of a group of names in proportion: ``anchor`` = sum of ``row`` by equation ``number``.

    No two names of the row are in proportion. An empty row holds the group at zero.
    """

    anchor: Hashable
    row: dict[Any, Any]
    number: int


@dataclass(eq=False, slots=True)
class ProportionalGroup:
    """Group of ``size`` unknowns in proportion to each other.

    ``lead`` stands for the group while there is no ``solution``.

    ``known`` holds the calculated ratios to the root of the tree. A group that was joined to another only points to it.
    """

    lead: Hashable
    size: int = 1
    solution: ProportionSolution | None = None
    joined: ProportionalGroup | None = None
    known: dict[Hashable, Any] | None = None


class ProportionLink(NamedTuple):
    """Link between two unknowns in proportion, in a tree of such links.

    ``own`` * name + ``of_above`` * ``above`` = 0 by equation ``number``.
    """

    above: Hashable
    own: Any
    of_above: Any
    number: int


@dataclass(eq=False)
class Proportions:
    """Groups of unknowns in proportion to each other, kept as trees of links; the links of a group make a tree."""

    _home: dict[Hashable, ProportionalGroup] = field(default_factory=dict)
    _links: dict[Hashable, ProportionLink] = field(default_factory=dict)

    def copy(self) -> Proportions:
        """Copy of the groups in proportion, to which links can be added."""
        again = {group: ProportionalGroup(group.lead, group.size, group.solution) for group in self.groups()}
        return Proportions({name: again[self.group(name)] for name in self._home}, dict(self._links))

    def names(self) -> list[Hashable]:
        """Names of all unknowns that appear in a link."""
        return list(self._home)

    def groups(self) -> list[ProportionalGroup]:
        """Groups of names in proportion, without duplicates."""
        return [group for group in dict.fromkeys(self._home.values()) if group.joined is None]

    def group(self, name: Hashable) -> ProportionalGroup:
        """Group of names in proportion to a name; a name without links is alone in its group."""
        group = self._home.get(name)
        if group is None:
            group = self._home[name] = ProportionalGroup(name)
        elif group.joined is not None:
            while group.joined is not None:
                group = group.joined
            self._home[name] = group
        return group

    def join(self, name: Hashable, link: ProportionLink) -> None:
        """Link a name to a name of another group, whose lead then stands for both groups."""
        upper, lower = self.group(link.above), self.group(name)
        lead = upper.lead
        if lower.size > upper.size:
            # The smaller tree is turned and goes into the larger one: no name then moves more than log n times.
            upper, lower = lower, upper
            name, link = link.above, ProportionLink(name, link.of_above, link.own, link.number)
        self.make_root(name)
        self._links[name] = link
        lower.joined = upper
        upper.size += lower.size
        upper.lead = lead

    def make_root(self, name: Hashable) -> None:
        """Turn the tree of links of a name so that the name is its root."""
        link = self._links.pop(name, None)
        if link is not None:
            self.group(name).known = None
        while link is not None:
            above, own, of_above, number = link
            link = self._links.get(above)
            self._links[above] = ProportionLink(name, of_above, own, number)
            name = above

    def to_root(
        self, name: Hashable, known: dict[Hashable, Any], product: Callable[[Any, Any], Any] = operator.mul
    ) -> Any:
        """Ratio of a name to the root of its tree of links; ``known`` stores the ratios of names on the way."""
        way = []
        while name not in known:
            link = self._links.get(name)
            if link is None:
                known[name] = 1
            else:
                way.append((name, link))
                name = link.above
        ratio = known[name]
        # From the root down, each name by one product.
        for name, link in reversed(way):
            ratio = known[name] = product(-link.of_above / link.own, ratio)
        return ratio

    def ratio(self, first: Hashable, second: Hashable) -> Any:
        """Ratio of two different names of one group, the first over the second.

        This is the ratio of their ratios to the root if these are short, else a product over the links between them.
        """
        group = self.group(first)
        if group.known is None:
            group.known = {}
        over, under = (self.to_root(name, group.known, short_product) for name in (first, second))
        if over is not None and under is not None:
            return over / under
        up, down = self._ways(first, second)
        # own x + of_above y = 0 with y above x: x is -(of_above/own) y on the way up, the inverse on the way down.
        factors = [-link.of_above / link.own for link in up] + [-link.own / link.of_above for link in down]
        ratio = factors[0]
        for factor in factors[1:]:
            ratio = ratio * factor
        return ratio

    def between(self, first: Hashable, second: Hashable) -> list[int]:
        """Numbers of the equations that link two unknowns of one group."""
        return [link.number for way in self._ways(first, second) for link in way]

    def _ways(self, first: Hashable, second: Hashable) -> tuple[list[ProportionLink], list[ProportionLink]]:
        """Links from each of two names up to their common name; both climb in turns, so neighbours meet soon."""
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
