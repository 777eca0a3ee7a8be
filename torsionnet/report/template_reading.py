"""Reading of template folders, with a check of all that one may hold, and rewording of a finished report by one.

Nothing leads out of a folder: templates name its files by their names alone, and links to other places are refused.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, TemplateSyntaxError, nodes

from torsionnet.base.errors import Fault, ModelError, Position, UsageError, did_you_mean, suggestion_or
from torsionnet.base.phrases import PLACEHOLDER, Phrase, phrase
from torsionnet.machinery.limits.shaft_limit import Society
from torsionnet.model.files.fault_places import located_faults, presentable_faults
from torsionnet.model.files.library import MOST_BYTES, decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.report.document_tree import (
    BreakableMath,
    Code,
    Details,
    Equations,
    Facts,
    Formula,
    Heading,
    Listing,
    Math,
    NumberText,
    Paragraph,
    Picture,
    Remark,
    Report,
    Section,
    Strong,
    TableBlock,
    TableGroup,
    TitleTable,
)
from torsionnet.report.wording import STYLE, TemplateFolder, TemplateFolderError, Wording, Words
from torsionnet.report.writers.templating import environment_of, shipped_blocks

# Reading of template folders, with a check of everything that one may hold.

# Languages of a report's own texts: English as the sections write it, others from files of words.

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


# Checks of the page of a template folder, as far as its text tells.

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
        faults = list(_faults(tree, shipped_blocks(name)))
        if not faults:
            environment.get_template(name)
    except TemplateSyntaxError as error:
        tag = _unknown_tag(environment, template.texts[name], error.lineno)
        text = f'no tag is named "{tag}"{suggestion_or(tag, _TAGS, "known: " + ", ".join(_TAGS))}' if tag else ""
        said = text or (error.message or "this is no template").rstrip(".")
        faults = [(error.lineno, said, "unknown-name" if text else "wrong-form")]
    return [Fault(text, position=template.position(name, line), kind=kind) for line, text, kind in faults]


def _unknown_tag(environment: Environment, text: str, line: int) -> str:
    """First tag of a line that Jinja does not have, or the empty text."""
    begun = False
    with suppress(TemplateSyntaxError):  # what cannot even be cut into words ends the search
        for number, kind, word in environment.lex(text):
            if begun and kind == "name" and number == line and word not in (*_TAGS, *_REFUSED_TAGS):
                return str(word)
            begun = kind == "block_begin" or (begun and kind == "whitespace")
    return ""


def _faults(tree: nodes.Template, known: tuple[str, ...]) -> Iterator[tuple[int, str, str]]:
    """Line, message and kind of each fault in the blocks of a page."""
    blocks = ", ".join(known)
    for other in tree.find_all(_OTHERS):
        text = f"a page of a template cannot include other files; write blocks: {blocks}"
        yield other.lineno, text, "forbidden-file"
    for joined in tree.find_all(nodes.Concat):
        yield joined.lineno, "texts cannot be joined by ~; write them one after the other", "wrong-form"
    for block in tree.find_all(nodes.Block):
        if block.name not in known:
            text = f'no block is named "{block.name}"{suggestion_or(block.name, known, f"there are {blocks}")}'
            yield block.lineno, text, "unknown-name"
    for node in tree.body:
        if not isinstance(node, _SILENT):
            for line in _shown(node) if isinstance(node, nodes.Output) else [node.lineno]:
                yield line, f"this stands in no block and would not be shown; blocks: {blocks}", "wrong-form"


def _shown(output: nodes.Output) -> Iterator[int]:
    """Line number of the first text in an output statement of a template that is not blank."""
    for node in output.nodes:
        text = node.data if isinstance(node, nodes.TemplateData) else "x"
        if text.strip():
            yield node.lineno + text[: len(text) - len(text.lstrip())].count("\n")
            return


PAGES = ("page.html", "page.tex", "page.md")
WORDS = "words.yaml"
IMAGES = (".svg", ".png", ".jpg", ".jpeg", ".pdf")
_IMAGE_NAME = re.compile(r"[A-Za-z0-9_-]+\.\w+")
_PUT_IN = "write {{{{ image('{0}') }}}} for a file of the folder"
"""Advice in error messages on how a page refers to an image of the template folder."""
_FROM_ELSEWHERE = {
    r"<(script|link|iframe|object|embed|base|form)\b": "a report runs no scripts and loads no other files; delete <{0}",
    r"@import\b": "a report loads no other style sheets; write the rules into style.css",
    r"\bsrc\s*=\s*[\"']?(?!data:|\{\{|[\"'])([^\"'\s>]+)": "a report holds its images; " + _PUT_IN,
    r"\burl\(\s*[\"']?(?!data:|#|\{\{|[\"'])([^\"')\s]+)": "a report holds its images; in page.html " + _PUT_IN,
}
"""Advice by pattern of what would make a page of a template folder load or run something."""


def read_template(path: str | os.PathLike[str]) -> TemplateFolder:
    """Texts, images, wording and language that a template folder holds.

    Raises
    ------
    UsageError
        There is no such folder.
    TemplateFolderError
        All faults of its files, each with its place.
    """
    folder = Path(path)
    names = _names(folder)
    faults = [fault for name in names if (fault := _no_part(folder, name, names))]
    refused = {fault.about for fault in faults}
    texts: dict[str, str] = {}
    images: dict[str, bytes] = {}
    for name in (name for name in names if name not in refused):
        try:
            data = (folder / name).read_bytes()
            if name in (*PAGES, STYLE, WORDS):
                texts[name] = decode(data, str(folder / name)).removeprefix("\ufeff")
            else:
                images[name] = data
        except ModelError as error:
            faults += error.faults
        except OSError as error:
            raise UsageError(
                f"{folder / name} cannot be read: {error.strerror or error}", kind="unreadable-file"
            ) from None
    words, faults_of_words = _words(texts.pop(WORDS, ""), str(folder / WORDS))
    faults += faults_of_words
    read = TemplateFolder(folder, texts, images, Wording(words.texts or {}), words.language)
    # Pages and style may load nothing from the network: documents are whole in themselves.
    faults += [fault for name in ("page.html", STYLE) for fault in _from_elsewhere(read, name)]
    faults += [fault for name in PAGES if name in texts for fault in page_faults(read, name)]
    if faults:
        raise TemplateFolderError(presentable_faults(faults), str(folder))
    return read


def _names(folder: Path) -> list[str]:
    """Names of the template folder's files; notes to its reader and hidden files are left out."""
    try:
        names = sorted(entry.name for entry in folder.iterdir())
    except NotADirectoryError:
        raise UsageError(
            f"{folder} is no folder; --template takes the folder that holds page.html", kind="wrong-file"
        ) from None
    except OSError as error:
        beside = folder.parent.iterdir() if folder.parent.is_dir() else ()
        hint = did_you_mean(folder.name, [entry.name for entry in beside if entry.is_dir()])
        kind = "missing-file" if isinstance(error, FileNotFoundError) else "unreadable-file"
        text = f"the template folder {folder} cannot be read: {error.strerror or error}{hint}"
        raise UsageError(text, kind=kind) from None
    return [name for name in names if not name.startswith((".", "README"))]


def _no_part(folder: Path, name: str, names: Iterable[str]) -> Fault | None:
    """Fault of a file in a template folder that cannot be part of a template; None where it can."""
    path, known = folder / name, (*PAGES, STYLE, WORDS)

    def fault(text: str, *, kind: str) -> Fault:
        return Fault(text, position=Position(str(path), 1, 1, 2), about=name, kind=kind)

    if not path.resolve().is_relative_to(folder.resolve()):
        return fault("this link leads out of the template folder; put a copy of the file there", kind="forbidden-file")
    if name not in known and Path(name).suffix.lower() not in IMAGES:
        rest = f"it may hold {', '.join(known)} and images ({', '.join(IMAGES)})"
        missing = [known_name for known_name in known if known_name not in names]
        return fault(f"this is no part of a template{suggestion_or(name, missing, rest)}", kind="unknown-name")
    if not path.is_file():
        return fault("a file is expected, not a folder or a device", kind="wrong-file")
    if path.stat().st_size > MOST_BYTES:
        return fault(f"the file is too large: more than {MOST_BYTES // 1_000_000} MB", kind="too-large")
    if name not in known and not _IMAGE_NAME.fullmatch(name):
        return fault("the name of an image has letters, digits, - and _, and one ending", kind="invalid-name")
    return None


def _words(text: str, file: str) -> tuple[Words, list[Fault]]:
    if not text.strip():
        return Words(), []
    try:
        document = compose(text, file)
    except ModelError as error:
        return Words(), list(error.faults)
    words, faults = Words.read(document.data)
    return words or Words(), located_faults([*document.faults, *faults], document)


def _from_elsewhere(template: TemplateFolder, name: str) -> Iterator[Fault]:
    """Faults of a page of a template folder that would load something from elsewhere, or run something."""
    text = template.texts.get(name, "")
    for pattern, advice in _FROM_ELSEWHERE.items():
        for link in re.finditer(pattern, text, re.IGNORECASE):
            line = text.count("\n", 0, link.start()) + 1
            column = link.start() - text.rfind("\n", 0, link.start())
            about = link[1] if link.re.groups else ""
            yield Fault(advice.format(about), position=template.position(name, line, column), kind="wrong-form")
    if name == STYLE and "</" in text:
        line = text.count("\n", 0, text.index("</")) + 1
        yield Fault(
            "a style sheet cannot hold tags; delete them", position=template.position(name, line), kind="wrong-form"
        )


# Rewording of a finished report, in which its own texts are replaced, and those of the model are not.

TEXT_FIELDS: dict[type, tuple[str, ...]] = {
    Report: ("subtitle", "facts", "sections", "title_block"),
    Section: ("title", "blocks"),
    Details: ("title", "blocks", "instead"),
    Paragraph: ("text",),
    Remark: ("text",),
    Listing: ("items",),
    TableGroup: ("title",),
    Heading: ("text", "unit"),
    Strong: ("text",),
}
"""Names of fields that hold the report's own texts, by class of the report's tree; formulas, numbers and code have
none."""
REWORDED_COLUMNS = {
    "Action",
    "Asked for",
    "Conclusion",
    "Data",
    "At",
    "Comparison",
    "Explanation",
    "From",
    "Kind",
    "Leading term",
    "Limit",
    "Limit in passing",
    "Of",
    "Property",
    "Quantity",
    "Sign",
    "Speeds not permitted",
    "Type",
    "Verdict",
    "To be barred",
    "What",
    "What is compared",
    "What it is",
    "What it sets",
}
"""Headings of columns whose cells hold words of the report, not of the model."""


@dataclass(frozen=True)
class Rewording:
    """Replacement of the texts of a finished report by other words."""

    wording: Wording

    def reworded(self, part: Any) -> Any:
        """Copy of a report, or of a part of it, in the words of the wording."""
        match part:
            case str():
                return self.wording(part)
            case tuple():
                return tuple(map(self.reworded, part))
            case Facts(rows):
                return Facts(tuple((self.wording(word), text) for word, text in rows))
            case None:
                return None
            case TitleTable():
                return self.title_table(part)
            case TableBlock():
                return self.table(part)
            case Picture():
                caption = self.reworded(part.caption)
                alt = self.wording(part.alt)
                if alt == part.alt and caption != part.caption:
                    alt = "".join(piece.latex if isinstance(piece, Math) else str(piece) for piece in caption)
                return replace(part, caption=caption, alt=alt)
            case Heading(text) if text in self.wording.names:
                return part
        return replace(part, **{name: self.reworded(getattr(part, name)) for name in TEXT_FIELDS.get(type(part), ())})

    def title_table(self, table: TitleTable) -> TitleTable:
        return replace(
            table,
            rows=tuple(tuple((self.wording(label), text) for label, text in row) for row in table.rows),
            revision_heads=self.reworded(table.revision_heads),
            signature_heads=self.reworded(table.signature_heads),
            signatures=tuple((self.wording(done), name) for done, name in table.signatures),
        )

    def table(self, table: TableBlock) -> TableBlock:
        heads = [column.text for column in table.columns]
        own = [head in REWORDED_COLUMNS or (heads[0], head) == ("Mode", "Description") for head in heads]
        groups = (
            replace(
                self.reworded(group),
                rows=tuple(
                    tuple(self.reworded(row[i]) if own[i] else self.cell(row[i]) for i in range(len(own)))
                    for row in group.rows
                ),
            )
            for group in table.groups
        )
        more = [(self.wording(phrase("… and {count} more", count=table.more)),)] if table.more else []
        said = {name: self.reworded(getattr(table, name)) for name in ("caption", "columns", "notes")}
        return replace(table, **said | {"groups": tuple(groups), "notes": (*said["notes"], *more), "more": 0})

    def cell(self, cell: Any) -> Any:
        """Cell of a column of names, in which phrases of the report alone are replaced."""
        if isinstance(cell, tuple):
            return tuple(map(self.cell, cell))
        return self.wording(cell) if isinstance(cell, Phrase) else cell


# Replacement of words and symbols in a finished report by those of a classification society.

AS_THEY_ARE = (Math, BreakableMath, Code, NumberText, Formula, Equations)
"""Classes of report parts, such as formulas and code, in which a society's words replace nothing."""
KEPT_FIELDS = frozenset({"name", "figure", "unit", "kind"})
"""Names of fields of a report's parts in which a society's words replace nothing."""


def in_society_words(part: Any, society: Society) -> Any:
    """Copy of a part of a report in which a society's words and symbols replace the report's own.

    Examples
    --------
    >>> from torsionnet.machinery.limits.shaft_limit import SOCIETIES
    >>> from torsionnet.report.document_tree import Paragraph
    >>> in_society_words(Paragraph(("tau_C is exceeded: barred range",)), SOCIETIES["lr"])
    Paragraph(text=('tau_c is exceeded: restricted speed range',))
    """
    if isinstance(part, Phrase):  # it stays one, with its places
        words = PLACEHOLDER.split(part.template)
        words[::2] = map(society.in_words, words[::2])
        words[1::2] = (f"{{{place}}}" for place in words[1::2])
        values = {place: in_society_words(value, society) for place, value in part.values.items()}
        return Phrase("".join(words), values)
    if isinstance(part, str):
        return society.in_words(part)
    if isinstance(part, tuple):
        return tuple(in_society_words(piece, society) for piece in part)
    if not is_dataclass(part) or isinstance(part, (type, *AS_THEY_ARE)):
        return part
    kept = {field.name: getattr(part, field.name) for field in fields(part) if field.name not in KEPT_FIELDS}
    return replace(part, **{name: in_society_words(value, society) for name, value in kept.items()})
