"""The mutation test itself: which faults it puts in, which it leaves out, and that every module has its tests."""

import ast
from pathlib import Path
from textwrap import dedent

import pytest
from mutation.__main__ import modules, sample
from mutation.chosen import CHOSEN, PACKAGES, chosen_for
from mutation.mutants import mutants
from mutation.trials import Trials

ROOT = Path(__file__).parents[1]


def faults(text):
    return {(mutant.old, mutant.new) for mutant in mutants("module.py", dedent(text))}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("c = a + b", {("a + b", "(a - b)")}),
        ("c = ä * b.T", {("ä * b.T", "(ä / b.T)"), ("b.T", "b")}),
        ("c = abs(z.real)", {("abs(z.real)", "z.real"), ("z.real", "z.imag")}),
        ("c = max(a, z.conj())", {("max(a, z.conj())", "min(a, z.conj())"), ("z.conj()", "z")}),
        ("c = -a", {("-a", "a")}),
        ("c = a < b", {("a < b", "(a >= b)")}),
        ("c = len(a) < n", {("len(a) < n", "(len(a) <= n)")}),
        ("c = a <= b < d", {("a <= b < d", "(a > b < d)"), ("a <= b < d", "(a <= b >= d)")}),
        ("c = a and b", {("a and b", "(a or b)")}),
        ("c = 5e-9, 0.5, 3, True", {("5e-9", "5e-06"), ("0.5", "1.0"), ("3", "4"), ("True", "False")}),
        ("if a:\n    b(c)", {("a", "(not a)"), ("b(c)", "pass")}),
        ("def f() -> float:\n    return a", {("a", "(-a)")}),
        ("def f() -> bool:\n    return a", {("a", "(not a)")}),
        ("def f(a):\n    raise E(-a)", {("raise E(-a)", "pass")}),
    ],
)
def test_faults(text, expected):
    assert faults(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        '"""A docstring with 1 + 1."""',
        "def f(a: A[1]) -> A[2]: ...",
        "K: TypeAlias = A[1]",
        "if TYPE_CHECKING:\n    a = 1",
        'msg = "at least" + f"{a + 1}"',
        'c = f"{a + 1}"',
        'c = a + "text"',
        "c = a + [b]",
        "class A:\n    def __repr__(self):\n        return 1",
        "c = zip(a, b, strict=True)",
        'c = Column("name", "", 3)',
        "@cache(1)\nclass A: ...",
    ],
)
def test_no_faults_where_no_result_depends_on_it(text):
    assert faults(text) == set()


def test_a_fault_is_one_piece_of_the_text():
    text = "c = (\n    ä\n    + b  # sum\n)\nd = 1\n"
    first, second = mutants("module.py", text)
    assert (first.line, first.function, first.applied(text)) == (2, 0, "c = (\n    (ä - b)  # sum\n)\nd = 1\n")
    assert (second.line, second.function, second.applied(text)) == (5, 0, "c = (\n    ä\n    + b  # sum\n)\nd = 2\n")


def test_the_function_around_a_fault():
    text = "class A:\n    @cache\n    def f(self):\n        def g():\n            return -a\n        return g\n\nb = 1"
    assert [mutant.function for mutant in mutants("module.py", text)] == [2, 0]


@pytest.mark.slow
def test_sample_is_seeded_spread_and_valid():
    first, again, other = (sample(list(PACKAGES[2:4]), 50, seed) for seed in (1, 1, 2))
    assert first == again != other
    assert len({mutant.module for mutant in first}) > 25
    for mutant in first:
        ast.parse(mutant.applied((ROOT / mutant.module).read_text(encoding="utf-8")))


def test_one_line_alone():
    (module, line) = ("torsionnet/signals/harmonics.py", 44)
    assert {(mutant.module, mutant.line) for mutant in sample([f"{module}:{line}"], 100, 1)} == {(module, line)}


def test_every_module_has_tests():
    found = modules(list(PACKAGES))
    for module in found:
        assert all((ROOT / path).exists() for path in chosen_for(module))
    assert all(any(module.startswith(start) for module in found) for start in CHOSEN)


@pytest.mark.slow
def test_trials_in_a_copy(tmp_path, monkeypatch):
    """With the doctests of a small module, which never see an empty array."""
    monkeypatch.setattr("mutation.trials.chosen_for", lambda module: [module])
    module = "torsionnet/signals/timing.py"
    text, trials = (ROOT / module).read_text(encoding="utf-8"), Trials(tmp_path, 60)
    faults = {mutant.old: mutant for mutant in mutants(module, text)}
    assert 0 < trials.usual(module) < 600
    assert not trials.survives(faults["intervals > GAP_RATIO * np.median(intervals)"])
    assert trials.survives(faults["0"])
    monkeypatch.setattr("mutation.trials.SPARE", 0.1)
    monkeypatch.setattr(trials, "usual", lambda _: 0.0)
    assert not trials.survives(faults["0"])
    assert (ROOT / module).read_text(encoding="utf-8") == (tmp_path / module).read_text(encoding="utf-8") == text
