"""Correlation entry of a study file, which says which parameters vary together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, unknown_name


@dataclass(frozen=True, kw_only=True)
class Correlation(Declared):
    """Linear correlation, from -1 to 1, of the values of parameters, of every two where more are named.

    The distributions are those of the parameters all the same; they are joined as functions of correlated normal
    variables (a Gaussian copula, in structural reliability Nataf's model).

    Examples
    --------
    >>> Correlation(between=["k_1", "k_2"], coefficient=0.6).to_data()
    {'between': ['k_1', 'k_2'], 'coefficient': 0.6}
    """

    kind: ClassVar[str] = "correlation"
    article: ClassVar[str] = "a correlation"
    form: ClassVar[str] = "{between: [k_1, k_2], coefficient: 0.6}"

    between: tuple[str, ...] = entry(Listed("parameters", Text("name of a parameter"), form="a list of parameters"))
    coefficient: float = entry(Value("linear correlation of the values, above -1 and below 1", "1", lower=None))

    def contradictions(self) -> list[Fault]:
        faults = []
        if len(self.between) < 2:
            faults.append(Fault("a correlation is between two parameters or more", ("between",)))
        faults += [
            Fault(f"{name} stands twice", ("between", index))
            for index, name in enumerate(self.between)
            if name in self.between[:index]
        ]
        if not -1 < self.coefficient < 1:
            text = f"a correlation lies between -1 and 1, got {self.coefficient:g}"
            if abs(self.coefficient) == 1:
                text = f"{text}; what follows another parameter exactly is an expression of that in the model"
            faults.append(Fault(text, ("coefficient",)))
        return faults

    @property
    def pairs(self) -> Iterator[tuple[str, str]]:
        """Pairs of names of all correlated parameters."""
        return combinations(self.between, 2)


def name_faults(correlations: Sequence[Correlation], random: Sequence[str], grid: Sequence[str]) -> list[Fault]:
    """Faults of correlations that name a parameter without distribution, or a pair twice."""
    faults = []
    seen: dict[frozenset[str], int] = {}
    for index, one in enumerate(correlations):
        for place, name in enumerate(one.between):
            path = (index, "between", place)
            if name in grid:
                text = (
                    f"{name} takes the values of a list or range one after the other, and can be correlated with none"
                )
                faults.append(Fault(f"{text}; give it a distribution", path))
            elif name not in random:
                rest = f"with a distribution there is {', '.join(random) or 'none'}"
                faults.append(unknown_name("varied parameter", name, random, path, rest=rest))
        for pair in map(frozenset, one.pairs):
            if pair in seen:
                text = f"the correlation of {' and '.join(sorted(pair))} is given twice"
                faults.append(Fault(text, (index, "between")))
            seen[pair] = index
    return faults
