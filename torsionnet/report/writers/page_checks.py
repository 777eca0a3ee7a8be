"""Checks of the page of a template folder, as far as its text tells."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from jinja2 import Environment, TemplateSyntaxError, nodes

from torsionnet.base.errors import Fault, suggestion_or
from torsionnet.report.template_folder import TemplateFolder
from torsionnet.report.writers.templating import environment_of, shipped_blocks

_TAGS = ("block", "endblock", "if", "elif", "else", "endif", "for", "endfor", "set", "endset", "macro", "endmacro")
_REFUSED_TAGS = ("extends", "include", "import", "from", "with", "endwith", "call", "endcall", "filter", "endfilter",
                 "raw", "endraw", "autoescape", "endautoescape", "print")  # fmt: skip
"""Names of the other tags of Jinja, which no page of a template needs."""
_OTHERS = (nodes.Extends, nodes.Include, nodes.Import, nodes.FromImport)
_SILENT = (nodes.Block, nodes.Macro, nodes.Assign, nodes.AssignBlock, *_OTHERS)
"""Kinds of Jinja statements that show nothing outside of all blocks, or are refused in any place."""


def page_faults(template: TemplateFolder, name: str) -> list[Fault]:
    """Faults in the syntax of a template folder's page, or else in its blocks."""
    environment = environment_of(name.removeprefix("page"), template)
    try:
        tree = environment.parse(template.texts[name])
        found = list(_faults(tree, shipped_blocks(name)))
        if not found:
            environment.get_template(name)
    except TemplateSyntaxError as error:
        tag = _unknown_tag(environment, template.texts[name], error.lineno)
        text = f'no tag is named "{tag}"{suggestion_or(tag, _TAGS, "known: " + ", ".join(_TAGS))}' if tag else ""
        found = [(error.lineno, text or (error.message or "this is no template").rstrip("."))]
    return [Fault(text, position=template.position(name, line)) for line, text in found]


def _unknown_tag(environment: Environment, text: str, line: int) -> str:
    """First tag of a line that Jinja does not have, or the empty text."""
    begun = False
    with suppress(TemplateSyntaxError):  # what cannot even be cut into words ends the search
        for number, kind, word in environment.lex(text):
            if begun and kind == "name" and number == line and word not in (*_TAGS, *_REFUSED_TAGS):
                return str(word)
            begun = kind == "block_begin" or (begun and kind == "whitespace")
    return ""


def _faults(tree: nodes.Template, known: tuple[str, ...]) -> Iterator[tuple[int, str]]:
    blocks = ", ".join(known)
    for other in tree.find_all(_OTHERS):
        yield other.lineno, f"a page of a template cannot include other files; write blocks: {blocks}"
    for joined in tree.find_all(nodes.Concat):
        yield joined.lineno, "texts cannot be joined by ~; write them one after the other"
    for block in tree.find_all(nodes.Block):
        if block.name not in known:
            yield (
                block.lineno,
                f'no block is named "{block.name}"{suggestion_or(block.name, known, f"there are {blocks}")}',
            )
    for node in tree.body:
        if not isinstance(node, _SILENT):
            for line in _shown(node) if isinstance(node, nodes.Output) else [node.lineno]:
                yield line, f"this stands in no block and would not be shown; blocks: {blocks}"


def _shown(output: nodes.Output) -> Iterator[int]:
    """Line number of the first text in an output statement of a template that is not blank."""
    for node in output.nodes:
        text = node.data if isinstance(node, nodes.TemplateData) else "x"
        if text.strip():
            yield node.lineno + text[: len(text) - len(text.lstrip())].count("\n")
            return
