"""Sampling entry of a study file, the number and method of the random draws."""

from __future__ import annotations

from dataclasses import dataclass
from math import log2
from typing import ClassVar

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault
from torsionnet.study.space.many import Many
from torsionnet.study.space.sampling_points import LatinHypercubePoints, RandomPoints, UnitPoints
from torsionnet.study.space.sampling_sobol import COORDINATE_BITS, SobolPoints

RANDOM, LATIN, SOBOL = "random", "latin_hypercube", "sobol"


@dataclass(frozen=True, kw_only=True)
class Samples(Declared):
    """Number, method and seed of the draws of parameters with a distribution.

    Random draws are independent of each other, which confidence intervals rest on. A Latin hypercube has one draw in
    each of ``count`` equally likely ranges of every parameter; a Sobol sequence fills the space evenly, best where
    ``count`` is a power of two. Of parameters that are correlated only the first has one draw in each of these ranges;
    the others follow it as their correlation says.

    Examples
    --------
    >>> Samples(method="sobol", count=1024).to_data()
    {'method': 'sobol', 'count': 1024}
    """

    kind: ClassVar[str] = "sampling"
    article: ClassVar[str] = "sampling"
    form: ClassVar[str] = "{method: random, count: 10000, seed: 1}"

    method: str = entry(OneOf("how values are drawn", (RANDOM, LATIN, SOBOL)), RANDOM)
    count: int = entry(Many("number of draws", upper=10**15))
    seed: int = entry(Count("another seed draws other values", lower=0, upper=2**32 - 1), 1)

    def contradictions(self) -> list[Fault]:
        if self.method == SOBOL and self.count > 2**COORDINATE_BITS:
            text = f"a Sobol sequence has at most {2**COORDINATE_BITS} points; take method: {RANDOM} or {LATIN}"
            return [Fault(text, ("count",))]
        return []

    def points(self, names: tuple[str, ...]) -> UnitPoints:
        """Sequence of points in the unit cube with a coordinate for the name of each parameter."""
        if self.method == SOBOL:
            return SobolPoints(len(names), self.count, self.seed)
        if self.method == LATIN:
            return LatinHypercubePoints(names, self.count, self.seed)
        return RandomPoints(names, self.seed)

    def remark(self) -> Fault | None:
        """Warning where a Sobol sequence has not a power of two points, None where it has."""
        if self.method != SOBOL or self.count & (self.count - 1) == 0:
            return None
        near = 2 ** round(log2(self.count))
        return Fault(
            f"a Sobol sequence is even only at powers of two; {near} draws serve better", ("count",), "warning"
        )
