"""First sentences of docstrings that cannot stand alone."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator
from typing import Any

from structure.modules import Module

FRAGMENT_WORDS = """
    of as with without by for in on at from to into onto out over under than what who whom whose which
    that those these such it its they their them he his if when where while until because so not nor and
    or but also like else only same likewise here there thus how why then now said one ones both either
    neither other others
"""
FRAGMENT_BEGINNINGS = frozenset(FRAGMENT_WORDS.split())
"""Words with which a phrase begins whose subject, or whose verb, stands elsewhere."""

FRAGMENT_PAIRS = re.compile(
    r"(?:the (?:same|other|others|rest|one|ones|first|last|latter)\b(?! \w+ (?:of|in|at|that|with))|all (?:that|of|those|there)\b|"
    r"(?:each|none|some|any) (?:of|that)\b|no more\b|see :)",
    re.IGNORECASE,
)
"""Beginnings of several words that refer to something said elsewhere."""

FEWEST_WORDS = 3
"""A shorter sentence on a function or constant names a thing without saying what about it ("W.", "Of rows.")."""
FEWEST_WORDS_OF_CLASS = 2
"""Modules and classes may be called by their name alone ("Flexible coupling.")."""


def first_sentence(text: str) -> str:
    """First sentence of a docstring on one line, without its full stop."""
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return re.split(r"(?<=[^.A-Z])[.:;](?:\s|$)", paragraph + " ")[0].strip()


def is_fragment(sentence: str, fewest: int = FEWEST_WORDS) -> bool:
    """Whether a first sentence cannot be understood without the code or a sentence before it."""
    words = re.findall(r"[^\s,]+", sentence)
    if not words or sentence.startswith(("See :", "``")):
        return False
    return len(words) < fewest or words[0].lower() in FRAGMENT_BEGINNINGS or bool(FRAGMENT_PAIRS.match(sentence))


def _scopes(node: ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[Any]:
    """Yield a module, class or function and those defined in it; expressions have no docstrings."""
    yield node
    for inner in node.body:
        if isinstance(inner, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield from _scopes(inner)


def documented(module: Module) -> Iterator[tuple[int, str, str, int]]:
    """Line, name, first sentence and least number of words of a module's docstrings, also of its constants."""
    for node in _scopes(module.tree):
        if text := ast.get_docstring(node):
            fewest = FEWEST_WORDS_OF_CLASS if isinstance(node, ast.Module | ast.ClassDef) else FEWEST_WORDS
            yield getattr(node, "lineno", 1), getattr(node, "name", module.name), first_sentence(text), fewest
        for before, after in itertools.pairwise(node.body):
            if isinstance(before, ast.Assign | ast.AnnAssign) and isinstance(after, ast.Expr):
                value = after.value
                if isinstance(value, ast.Constant) and isinstance(value.value, str):
                    target = before.targets[0] if isinstance(before, ast.Assign) else before.target
                    yield after.lineno, ast.unparse(target), first_sentence(value.value), FEWEST_WORDS


def fragments(module: Module) -> Iterator[tuple[int, str, str]]:
    """Line, name and sentence of every first sentence of a module that is a fragment."""
    for line, name, sentence, fewest in documented(module):
        if is_fragment(sentence, fewest):
            yield line, name, sentence
