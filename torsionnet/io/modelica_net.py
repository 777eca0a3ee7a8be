"""Declarations and connection sets of a Modelica model while its text is put together."""

from __future__ import annotations

from torsionnet.base.plain_names import Names
from torsionnet.base.registers import Groups


class Net:
    """Declarations of a Modelica model, and the points that are connected (nodes, ports of elements, flanges)."""

    def __init__(self, names: Names) -> None:
        self.names = names
        self.declarations: list[str] = []
        self.equations: list[str] = []
        self.points: Groups[str] = Groups[str]()

    def declare(self, kind: str, wish: str, values: str = "", comment: str = "") -> str:
        """Declare a Modelica component of a type and return its name."""
        name = self.names.new(wish)
        modifiers = f"({values})" if values else ""
        self.declarations.append(f"{kind} {name}{modifiers}{f' {comment}' if comment else ''};")
        return name

    def connections(self) -> list[str]:
        """Lines of ``connect`` equations from the first flange of every set to all others, with the set's nodes."""
        lines: list[str] = []
        for name, points in self.points.home.items():
            if points[0] != name:
                continue
            flanges = [point for point in points if ":" not in point]
            nodes = [point.removeprefix("node:") for point in points if point.startswith("node:")]
            if len(flanges) > 1:
                lines.append(f"// {', '.join(nodes) or 'inside an element'}")
                lines += [f"connect({flanges[0]}, {other});" for other in flanges[1:]]
        return lines
