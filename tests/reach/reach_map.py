"""The map from functions of the package to the tests that call them, and what can be asked of it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from reach.recording import ROOT

MAP = ROOT / ".cache" / "reach.npz"


@dataclass(frozen=True)
class ReachMap:
    """Tests with what they reach.

    ``reached[bounds[i]:bounds[i + 1]]`` are the numbers, in ``places``, of what ``tests[i]`` reaches.
    """

    tests: list[str]
    seconds: np.ndarray
    """Processor time of each test, with the processes it starts."""
    slow: np.ndarray
    places: list[str]
    bounds: np.ndarray
    reached: np.ndarray

    @classmethod
    def of(cls, notes: dict[str, tuple[float, bool, list[str]]]) -> ReachMap:
        """From processor time, mark and places of each test."""
        places = sorted({place for *_, reached in notes.values() for place in reached})
        numbers = {place: number for number, place in enumerate(places)}
        rows = [[numbers[place] for place in reached] for *_, reached in notes.values()]
        return cls(
            list(notes),
            np.array([seconds for seconds, *_ in notes.values()]),
            np.array([slow for _, slow, _ in notes.values()]),
            places,
            np.cumsum([0, *map(len, rows)]),
            np.concatenate([np.array(row, int) for row in rows]) if rows else np.array([], int),
        )

    def write(self, file: Path) -> None:
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(
            file, tests=np.array(self.tests), seconds=self.seconds, slow=self.slow, places=np.array(self.places),
            bounds=self.bounds, reached=self.reached.astype(np.int32),
        )  # fmt: skip

    @classmethod
    def read(cls, file: Path = MAP) -> ReachMap:
        """The map of the last ``make reach``; SystemExit where there is none."""
        if not file.exists():
            raise SystemExit("no map of what tests reach yet: make reach")
        with np.load(file) as kept:
            return cls(
                kept["tests"].tolist(),
                kept["seconds"],
                kept["slow"],
                kept["places"].tolist(),
                kept["bounds"],
                kept["reached"],
            )

    @cached_property
    def numbers(self) -> dict[str, int]:
        return {place: number for number, place in enumerate(self.places)}

    @cached_property
    def _test_of(self) -> np.ndarray:
        return np.repeat(np.arange(len(self.tests)), np.diff(self.bounds))

    def reaching(self, place: str) -> np.ndarray:
        """Numbers of the tests that reach a place, the cheapest first.

        Of a place that no test reaches, as a constant or a class body, those that reach its file at all.
        """
        if place in self.numbers:
            wanted = [self.numbers[place]]
        else:
            file = place.partition(":")[0]
            wanted = [number for number, name in enumerate(self.places) if name.partition(":")[0] == file]
        tests = np.unique(self._test_of[np.isin(self.reached, wanted)])
        return tests[np.argsort(self.seconds[tests], kind="stable")]


def functions(text: str) -> dict[int, str]:
    """By line, the outermost function or method around it as it is named in the map; its decorators belong to it."""
    names: dict[int, str] = {}

    def visit(body: list[ast.stmt], within: str) -> None:
        for node in body:
            if isinstance(node, ast.ClassDef):
                visit(node.body, f"{within}{node.name}.")
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                begin = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
                names.update(dict.fromkeys(range(begin, (node.end_lineno or begin) + 1), f"{within}{node.name}"))
            elif isinstance(node, ast.If | ast.Try | ast.With):
                visit([child for child in ast.iter_child_nodes(node) if isinstance(child, ast.stmt)], within)

    visit(ast.parse(text).body, "")
    return names
