"""A report through the templates of one format. All they show passes the format's own function for text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

from jinja2 import FunctionLoader, StrictUndefined
from jinja2.sandbox import ImmutableSandboxedEnvironment
from markupsafe import Markup

from torsionnet.report.document_tree import Cell, Inline, Picture, Report
from torsionnet.report.writers.numbering import placed

SHIPPED = files("torsionnet.report.writers") / "templates"


@dataclass(frozen=True)
class TextFormat:
    """One way to write a report.

    Attributes
    ----------
    ending : str
        Of the templates ``page`` and ``blocks``.
    inline : function
        A cell, caption or paragraph as text of the format; nothing else reaches the file.
    tools : mapping
        Functions that the templates call, each of which gives text of the format.
    tags : mapping
        How templates are told from text; default: as usual with Jinja.
    """

    ending: str
    inline: Callable[[Cell], str]
    tools: Mapping[str, Callable[..., str]]
    tags: Mapping[str, str] = field(default_factory=dict)

    def shown(self, value: Any) -> Markup:
        """A value as text of the format; what a template has made is that already."""
        if isinstance(value, Markup):
            return value
        return Markup(self.inline(value if isinstance(value, Inline | tuple) else str(value)))


def written(report: Report, target: TextFormat, drawing: Callable[[Picture, str], str], *, folds: bool = False) -> str:
    """The text of a report; ``drawing`` shows a figure of a name and number."""
    environment = _environment(target)
    tools = {name: _marked(tool) for name, tool in {**target.tools, "drawing": drawing}.items()}
    blocks: Any = environment.get_template(f"blocks{target.ending}").make_module({**tools, "word": str})
    return environment.get_template(f"page{target.ending}").render(
        title=report.title,
        subtitle=report.subtitle,
        notes=report.notes if any(report.notes) else "",
        facts=blocks.facts(report.facts.rows),
        contents=report.sections,
        sections=blocks.all(placed(report.sections, folds=folds)),
        style=Markup((SHIPPED / "style.css").read_text(encoding="utf-8")),
        language="en",
        word=str,
    )


def _marked(tool: Callable[..., str]) -> Callable[..., Markup]:
    return lambda *given: Markup(tool(*given))


def _environment(target: TextFormat) -> ImmutableSandboxedEnvironment:
    environment = ImmutableSandboxedEnvironment(
        loader=FunctionLoader(lambda name: (SHIPPED / name).read_text(encoding="utf-8")),
        autoescape=True,
        finalize=target.shown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        **target.tags,
    )
    del environment.filters["safe"]
    return environment
