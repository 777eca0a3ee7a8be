"""Languages of a report's own texts: English as the sections write it, others from files of words."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

from torsionnet.model.files.located_yaml import compose
from torsionnet.report.template_folder import TemplateFolder
from torsionnet.report.wording import Wording, Words

ENGLISH = "en"
"""Code of the language in which the sections of a report write their texts."""


@cache
def words_of(language: str) -> Words:
    """Texts of a report in a language by the English ones, from the file ``words/LANGUAGE.yaml``.

    Examples
    --------
    >>> words_of("de").texts["Contents"]
    'Inhalt'
    """
    name = f"{language}.yaml"
    text = files("torsionnet.report").joinpath("words", name).read_text(encoding="utf-8")
    data: dict[str, Any] = compose(text, name).data
    return Words(**data)


def in_language(language: str, template: TemplateFolder | None) -> TemplateFolder | None:
    """Template folder whose words are those of a language, replaced by its own where it has any.

    None for English without a template.
    """
    if language == ENGLISH:
        return template
    words, own = words_of(language), template or TemplateFolder()
    texts = {**(words.texts or {}), **own.wording.texts}
    return replace(own, wording=Wording(texts), language=language if own.language == ENGLISH else own.language)
