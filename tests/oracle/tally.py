"""What was compared, how far it was off, and what was found wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf, isfinite


@dataclass(frozen=True)
class Finding:
    """One value (or refusal) that is not right."""

    seed: str
    quantity: str
    what: str
    exact: str = ""
    got: str = ""
    deviation: float = inf

    def __str__(self) -> str:
        off = f" ({self.deviation:.2g})" if isfinite(self.deviation) else ""
        values = f": exact {self.exact}, got {self.got}{off}" if self.exact or self.got else ""
        return f"{self.seed} {self.quantity}: {self.what}{values}"


CROSS_CHECK = "responses, dense"
"""LAPACK on assembled matrices loses digits by its nature: how often is shown, and is no finding."""


@dataclass
class Line:
    """Counts of one quantity; ``worst`` is the largest deviation without a warning."""

    tolerance: float
    models: set[str] = field(default_factory=set)
    values: int = 0
    worst: float = 0.0
    beyond: int = 0
    warned: int = 0
    refused: int = 0


class Tally:
    """Counts of all quantities, and the findings in the order in which they were made."""

    def __init__(self) -> None:
        self.lines: dict[str, Line] = {}
        self.findings: list[Finding] = []
        self.roles: Counter[str] = Counter()
        self.models = 0

    def line(self, quantity: str, tolerance: float) -> Line:
        return self.lines.setdefault(quantity, Line(tolerance))

    def agreed(self, seed: str, quantity: str, deviation: float, tolerance: float, count: int = 1) -> None:
        line = self.line(quantity, tolerance)
        line.models.add(seed)
        line.values += count
        line.worst = max(line.worst, deviation)

    def wrong(self, finding: Finding, tolerance: float) -> None:
        line = self.line(finding.quantity, tolerance)
        line.models.add(finding.seed)
        line.values += 1
        line.beyond += 1
        line.worst = max(line.worst, finding.deviation)
        if finding.quantity != CROSS_CHECK:
            self.findings.append(finding)

    def excused(self, seed: str, quantity: str, tolerance: float, *, refused: bool = False) -> None:
        """A value that the package itself calls uncertain, or a question it rightly refuses."""
        line = self.line(quantity, tolerance)
        line.models.add(seed)
        if refused:
            line.refused += 1
        else:
            line.values += 1
            line.warned += 1

    def join(self, others: Iterable[Tally]) -> Tally:
        for other in others:
            self.models += other.models
            self.roles += other.roles
            self.findings += other.findings
            for name, line in other.lines.items():
                own = self.line(name, line.tolerance)
                own.models |= line.models
                own.worst = max(own.worst, line.worst)
                for count in ("values", "beyond", "warned", "refused"):
                    setattr(own, count, getattr(own, count) + getattr(line, count))
        return self

    @property
    def values(self) -> int:
        return sum(line.values for line in self.lines.values())

    @property
    def beyond(self) -> int:
        return sum(line.beyond for name, line in self.lines.items() if name != CROSS_CHECK)

    def table(self) -> str:
        """One line per quantity, as text."""
        head = ("quantity", "models", "values", "worst", "tolerance", "beyond it", "warned", "refused")
        rows = [
            (name, len(x.models), x.values, f"{x.worst:.1e}", f"{x.tolerance:.0e}", x.beyond, x.warned, x.refused)
            for name, x in self.lines.items()
        ]
        rows.append(
            ("all", self.models, self.values, "", "", self.beyond,
             sum(x.warned for x in self.lines.values()), sum(x.refused for x in self.lines.values()))
        )  # fmt: skip
        cells = [head, *[tuple(map(str, row)) for row in rows]]
        widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
        return "\n".join(
            "  ".join(
                cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))
            )
            for row in cells
        )

    def distinct(self) -> list[Finding]:
        """The first finding of every model in every quantity."""
        return list({(f.seed, f.quantity): f for f in reversed(self.findings)}.values())[::-1]

    def role_table(self) -> str:
        """In how many models each element stood in each role."""
        groups: dict[str, list[str]] = {}
        for role, count in sorted(self.roles.items()):
            kind, place = role.split(": ")
            groups.setdefault(kind, []).append(f"{place} {count}")
        return "\n".join(f"{kind}: {', '.join(places)}" for kind, places in groups.items())
