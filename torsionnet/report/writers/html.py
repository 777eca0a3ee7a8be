"""A report as one HTML page that needs nothing else: pictures and formulas are in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

from torsionnet.report.document_tree import (
    Block,
    Details,
    Equations,
    Facts,
    Formula,
    Listing,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    TableBlock,
)
from torsionnet.report.writers.html_table import table_html
from torsionnet.report.writers.html_text import escaped, inline
from torsionnet.report.writers.mathml import mathml

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def html_page(report: Report, *, folds: bool = True) -> str:
    """The text of the page; one to be printed does not fold anything away."""
    writer = _Writer(folds)
    body = "\n".join(writer.section(section, (number,)) for number, section in enumerate(report.sections, 1))
    style = files("torsionnet.report.writers").joinpath("page.css").read_text(encoding="utf-8")
    notes = f"<p class=lead>{inline(report.notes)}</p>" if any(report.notes) else ""
    return (
        "<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n"
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        '<meta name=viewport content="width=device-width, initial-scale=1">\n'
        '<meta name=color-scheme content="light dark">\n'
        f"<title>{escaped(report.title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<main>\n"
        f"<header><p class=kind>{escaped(report.subtitle)}</p><h1>{escaped(report.title)}</h1>\n"
        f"{writer.facts(report.facts)}{notes}</header>\n"
        f"<nav aria-label=Contents><h2>Contents</h2><ol>{''.join(map(_entry, report.sections))}</ol></nav>\n"
        f"{body}\n</main>\n</body>\n</html>\n"
    )


def _entry(section: Section) -> str:
    return f'<li><a href="#{escaped(section.name)}">{inline(section.title)}</a></li>'


@dataclass
class _Writer:
    """Counts tables, figures and formulas as it goes."""

    folds: bool = True
    series: str = ""
    """Before the numbers of what is folded away: paper, which leaves it out, has the same numbers without it."""
    counts: Counter[str] = field(default_factory=Counter)

    def label(self, what: str) -> str:
        self.counts[self.series + what] += 1
        return f"{what} {self.series}{self.counts[self.series + what]}"

    def section(self, section: Section, numbers: tuple[int, ...]) -> str:
        level, shown = min(len(numbers) + 1, 6), ".".join(map(str, numbers))
        parts, below = [], 0
        for block in section.blocks:
            if isinstance(block, Section):
                below += 1
                parts.append(self.section(block, (*numbers, below)))
            else:
                parts.append(self.block(block))
        head = f"<h{level}><span class=no>{shown}</span> {inline(section.title)}</h{level}>"
        return f'<section id="{escaped(section.name)}">\n{head}\n' + "\n".join(parts) + "\n</section>"

    def block(self, block: Block) -> str:
        writers: dict[type, Callable[[Any], str]] = {
            Paragraph: lambda one: f"<p>{inline(one.text)}</p>",
            Listing: lambda one: f"<ul>{''.join(f'<li>{inline(item)}</li>' for item in one.items)}</ul>",
            Remark: self.remark,
            Formula: self.formula,
            Equations: lambda one: "".join(f"<p class=equation>{inline(row)}</p>" for row in one.rows),
            TableBlock: lambda one: table_html(one, self.label("Table")),
            Picture: self.picture,
            Details: self.details,
            Facts: self.facts,
        }
        return writers[type(block)](block)

    @staticmethod
    def remark(block: Remark) -> str:
        return f"<p class='remark {escaped(block.kind)}'><b>{block.kind.capitalize()}:</b> {inline(block.text)}</p>"

    def details(self, block: Details) -> str:
        if not self.folds:
            return f"<p>{inline(block.instead)}</p>"
        self.series = "S"
        inner = "\n".join(self.block(one) for one in block.blocks)
        self.series = ""
        return f"<details><summary>{inline(block.title)}</summary>\n{inner}\n</details>"

    def formula(self, block: Formula) -> str:
        number = self.label("Formula").removeprefix("Formula ")
        shown = f"<div class=scroll>{mathml(block.latex, block=True)}</div>"
        return f"<div class=formula>{shown}<span>({number})</span></div>"

    @staticmethod
    def facts(facts: Facts) -> str:
        rows = "".join(f"<dt>{escaped(word)}</dt><dd>{inline(text)}</dd>" for word, text in facts.rows)
        return f"<dl>{rows}</dl>"

    def picture(self, block: Picture) -> str:
        from torsionnet.plot.rendering import inline_svg

        label = self.label("Figure")
        svg = inline_svg(block.drawn, f"f{self.counts['Figure']}-")
        svg = svg.replace("<svg ", f'<svg role=img aria-label="{escaped(block.alt)}" ', 1)
        caption = f"<figcaption><b>{label}</b> {inline(block.caption)}</figcaption>"
        return f"<figure><div class=scroll>{svg}</div>{caption}</figure>"
