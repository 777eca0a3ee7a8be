"""Texts of a report that say a sentence of ``texts.yaml`` with values in it, and were not made as phrases."""

import re
from dataclasses import fields, is_dataclass

from torsionnet.base.phrases import PLACEHOLDER, Phrase
from torsionnet.report.document_tree import BreakableMath, Code, Equations, Formula, Math, NumberText
from torsionnet.report.wording import replaceable_texts

OTHERS = (Math, BreakableMath, Code, NumberText, Formula, Equations)
"""Parts of a report without words."""
NOT_SHOWN = {"name", "figure", "alt", "unit", "kind", "template"}
"""Fields of a report's parts that hold no words of it, or those for readers who cannot see a figure."""
NEXT_TO_WORDS = r"(?:(?:[,;] | in | of | at | for | \().*?)?"
"""Regular expression of what continues a sentence at a place right behind a word, or of nothing."""


def unphrased(report):
    """Texts of a report that match a template of those that may be replaced and are no phrases, with that template."""
    return {text: of for text in plain_texts(report) if (of := template_of(text))}


def template_of(text):
    """The template that a text matches, or nothing."""
    if text in TEXTS:
        return None
    return next((template for pattern, template in PATTERNS if pattern.fullmatch(text)), None)


def plain_texts(part):
    """Every text of a part of a report that is no phrase."""
    if isinstance(part, str):
        if not isinstance(part, Phrase):
            yield part
    elif isinstance(part, tuple):
        for one in part:
            yield from plain_texts(one)
    elif is_dataclass(part) and not isinstance(part, OTHERS):
        for field in fields(part):
            if field.name not in NOT_SHOWN:
                yield from plain_texts(getattr(part, field.name))


def _pattern(template):
    literal, *rest = PLACEHOLDER.split(template)
    pattern = re.escape(literal)
    for before, after in zip([literal, *rest[1::2]], rest[1::2], strict=False):
        pattern += (NEXT_TO_WORDS if before[-1:].isalpha() else "[^.;:(]+?") + re.escape(after)
    return re.compile(pattern, re.DOTALL)


TEXTS = {text for texts in replaceable_texts().values() for text in texts}
PATTERNS = [
    (_pattern(text), text)
    for text in sorted(TEXTS)
    if PLACEHOLDER.search(text) and len(re.findall(r"[^\W\d_]{2,}", PLACEHOLDER.sub("", text))) > 1
]
"""Regular expressions of the templates with two words or more beside their places."""
