"""The mutation test itself: which faults it puts in, which it leaves out, and what it says of them."""

import ast
from pathlib import Path
from textwrap import dedent

import pytest

pytest.importorskip("resource", reason="small faults are tried where processes can be forked")

from mutation.__main__ import sample, shares
from mutation.equivalent import reason_of
from mutation.mutants import Mutant, mutants
from mutation.trials import Outcome, Trials
from reach.reach_map import ReachMap

ROOT = Path(__file__).parents[2]


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
    assert (first.line, first.function, first.applied(text)) == (2, "", "c = (\n    (ä - b)  # sum\n)\nd = 1\n")
    assert (second.line, second.function, second.applied(text)) == (5, "", "c = (\n    ä\n    + b  # sum\n)\nd = 2\n")


def test_the_function_around_a_fault():
    text = "class A:\n    @cache\n    def f(self):\n        def g():\n            return -a\n        return g\n\nb = 1"
    assert [mutant.function for mutant in mutants("module.py", text)] == ["A.f", ""]


def test_sample_is_seeded_spread_and_valid():
    first, again, other = (sample(["torsionnet/machinery/limits"], 20, seed) for seed in (1, 1, 2))
    assert first == again != other
    assert len({mutant.module for mutant in first}) > 10
    for mutant in first:
        ast.parse(mutant.applied((ROOT / mutant.module).read_text(encoding="utf-8")))


def test_one_line_alone():
    (module, line) = ("torsionnet/signals/order_tracking.py", 47)
    assert {(mutant.module, mutant.line) for mutant in sample([f"{module}:{line}"], 100, 1)} == {(module, line)}


def test_equivalent_faults_are_known_by_their_names(tmp_path, monkeypatch):
    names = tmp_path / "names.txt"
    names.write_text("# a.py:: 1 -> 2 | not this\na.py:: 1 -> 2 | both count from there\n", encoding="utf-8")
    monkeypatch.setattr("mutation.equivalent.NAMES", names)
    (first, second) = mutants("a.py", "x = 1\ny = 3\n")
    assert (reason_of(first), reason_of(second)) == ("both count from there", None)


def test_living_faults_are_counted_by_room():
    (mutant,) = mutants("torsionnet/signals/a.py", "x = 1\n")
    words = ("noticed", "survived", "undecided", "equal")
    assert shares([Outcome(mutant, word) for word in words]) == [
        "torsionnet/signals: 2 of 3 live (67 %), 1 equivalent ones set aside",
        "all: 2 of 3 live (67 %), 1 equivalent ones set aside",
    ]


@pytest.mark.slow
def test_trials_in_a_copy(tmp_path):
    """With the doctest of a small module, which never sees an empty array, and faults that no test reaches or in no time."""
    module = "torsionnet/signals/resampling.py"
    test = f"{module}::torsionnet.signals.resampling.gaps"
    text = (ROOT / module).read_text(encoding="utf-8")
    faults = {mutant.old: mutant for mutant in mutants(module, text)}
    seen, unseen = faults["intervals > GAP_RATIO * np.median(intervals)"], faults["0"]
    place = f"{module}:{seen.function}"
    reach = ReachMap.of({f"{test}_as_it_was": (0.5, False, [place]), test: (1.0, False, [place])})
    trials = Trials(tmp_path, reach, 60, 1)
    elsewhere = Mutant("torsionnet/drivetrain.py", 1, "load", 0, 0, "", "")
    outcomes = list(trials.outcomes([seen, unseen, elsewhere]))
    assert [(outcome.word, outcome.by) for outcome in outcomes] == [
        ("noticed", test),
        ("survived", ""),
        ("undecided", "no test reaches it"),
    ]
    assert (ROOT / module).read_text(encoding="utf-8") == (tmp_path / "0" / module).read_text(encoding="utf-8") == text
