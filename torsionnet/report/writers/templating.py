"""Rendering of a report through the Jinja templates of one format; all text passes the format's own function.

A page of a template folder replaces blocks of the page that is shipped. It sees text only, nothing of the model or the
program, and runs in Jinja's sandbox.
"""

from __future__ import annotations

import contextlib
import re
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined, TemplateError, TemplateRuntimeError
from jinja2.sandbox import ImmutableSandboxedEnvironment
from jinja2.utils import missing
from markupsafe import Markup

from torsionnet.base.atomic import write_bytes, write_text
from torsionnet.base.errors import Fault, suggestion_or
from torsionnet.report.document_tree import Cell, Inline, Picture, Report
from torsionnet.report.template_folder import STYLE, TemplateFolder, TemplateFolderError
from torsionnet.report.writers.numbering import number_blocks

SHIPPED = files("torsionnet.report.writers") / "templates"
"""Folder of the report templates that come with this package."""
ALLOWED_FILTERS = (
    "capitalize",
    "default",
    "first",
    "last",
    "length",
    "lower",
    "min",
    "title",
    "trim",
    "truncate",
    "upper",
)
"""Names of the filters that a template may use, none of which returns a text that would pass for markup."""
PAGE_NAMES = (
    "title",
    "subtitle",
    "title_block",
    "facts",
    "notes",
    "contents",
    "sections",
    "author",
    "date",
    "language",
    "word",
    "image",
)
"""Names that a page of a template folder can show or call."""
TEMPLATE_TAGS = {
    ".tex": {
        "block_start_string": "<%", "block_end_string": "%>",
        "variable_start_string": "<<", "variable_end_string": ">>",
        "comment_start_string": "<!--", "comment_end_string": "-->",
    }
}  # fmt: skip
"""Signs around template statements, by file ending, for formats in which braces have another meaning."""
_WRONG = (TemplateError, ArithmeticError, LookupError, TypeError, ValueError, AttributeError, RuntimeError, MemoryError)
"""Classes of exceptions that an expression in a template can cause."""


@dataclass(frozen=True)
class TextFormat:
    """File format of a report, with the functions that turn its parts into text.

    Attributes
    ----------
    ending : str
        Of the templates ``page`` and ``blocks``.
    inline : function
        A cell, caption or paragraph as text of the format; nothing else reaches the file.
    tools : mapping
        Functions that the templates of blocks call, each of which gives text of the format.
    images : tuple of str
        Endings of the images that it can show.
    """

    ending: str
    inline: Callable[[Cell], str]
    tools: Mapping[str, Callable[..., str]]
    images: tuple[str, ...]

    def shown(self, value: Any) -> Markup:
        """Text, in the report's file format, of a value that a template inserts.

        What a template has rendered is that already.
        """
        if isinstance(value, Markup):
            return value
        return Markup(self.inline(value if isinstance(value, Inline | tuple) else str(value)))


@dataclass(frozen=True)
class Illustrations:
    """Functions that return the markup by which a report's file shows a figure, or an image of the template folder.

    Attributes
    ----------
    drawing : function
        A figure and its number.
    image : function
        Name and bytes of an image of the template folder, as what follows ``src=`` or stands in ``\\includegraphics``.
    """

    drawing: Callable[[Picture, str], str]
    image: Callable[[str, bytes], str]


def render(report: Report, target: TextFormat, figures: Illustrations, *, folds: bool = False) -> str:
    """Text of a whole report in a file format."""
    template = report.template or TemplateFolder()
    environment = environment_of(target.ending, template, target.shown)
    tools = {name: _marked(tool) for name, tool in {**target.tools, "drawing": figures.drawing}.items()}
    blocks: Any = environment.get_template(f"blocks{target.ending}").make_module({**tools, "word": template.wording})
    given = {
        "title": report.title,
        "subtitle": report.subtitle,
        "author": report.author,
        "date": report.date,
        "notes": target.shown(report.notes) if any(report.notes) else "",
        "title_block": blocks.title_block(report.title_block) if report.title_block else "",
        "facts": blocks.facts(report.facts.rows),
        "contents": [{"name": section.name, "title": target.shown(section.title)} for section in report.sections],
        "sections": blocks.all(number_blocks(report.sections, folds=folds)),
        "language": template.language,
        "word": template.wording,
        "image": lambda name: Markup(figures.image(name, _image(template, name, target.images))),
        "style": Markup((SHIPPED / STYLE).read_text(encoding="utf-8") + template.texts.get(STYLE, "")),
    }
    try:
        return environment.get_template(f"page{target.ending}").render(given)
    except _WRONG as error:
        raise _located(error, template, f"page{target.ending}") from None


def environment_of(ending: str, template: TemplateFolder, shown: Callable[[Any], Markup] | None = None) -> Environment:
    """Jinja environment with the templates of one format, those of the template folder first."""

    def source(name: str) -> tuple[str, str, Callable[[], bool]]:
        text = template.texts.get(name)
        if text is None:
            return _shipped(name.removeprefix("shipped/")), f"shipped/{name}", lambda: True
        begin, end = environment.block_start_string, environment.block_end_string
        return f'{begin} extends "shipped/{name}" {end}{text}', template.file(name), lambda: True

    environment = _Sandbox(
        loader=FunctionLoader(source),
        autoescape=True,
        finalize=shown,
        undefined=_Unknown,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        **TEMPLATE_TAGS.get(ending, {}),
    )
    environment.globals.clear()
    environment.filters = {name: environment.filters[name] for name in ALLOWED_FILTERS}
    return environment


def shipped_blocks(name: str) -> tuple[str, ...]:
    """Names of the blocks of a page that a template folder may replace."""
    return tuple(environment_of(name.removeprefix("page"), TemplateFolder()).get_template(name).blocks)


@cache
def _shipped(name: str) -> str:
    return (SHIPPED / name).read_text(encoding="utf-8")


def _marked(tool: Callable[..., str]) -> Callable[..., Markup]:
    return lambda *given: Markup(tool(*given))


def _image(template: TemplateFolder, name: Any, endings: tuple[str, ...]) -> bytes:
    if name not in template.images:
        there = f"there are: {', '.join(template.images) or 'none'}"
        raise TemplateRuntimeError(f'no image is named "{name}"{suggestion_or(str(name), template.images, there)}')
    if not str(name).lower().endswith(endings):
        raise TemplateRuntimeError(f'"{name}" cannot be shown here; an image ends in {", ".join(endings)}')
    return template.images[name]


def _located(error: Exception, template: TemplateFolder, name: str) -> Exception:
    """Error of a template with its line in the page of the template folder."""
    if name not in template.texts:
        return error
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == template.file(name)
    ]
    text = re.sub(r"'([^']*)'", r'"\1"', str(error) or type(error).__name__).rstrip(".")
    place = template.position(name, (lines and lines[-1]) or 1)
    return TemplateFolderError([Fault(text, position=place)], str(template.path))


class _Sandbox(ImmutableSandboxedEnvironment):
    """Jinja sandbox that refuses to join texts, which would be escaped as in HTML in any format."""

    intercepted_binops = frozenset("+*%")

    def call_binop(self, context: Any, operator: str, left: Any, right: Any) -> Any:
        if isinstance(left, str) or isinstance(right, str):
            raise TemplateRuntimeError("texts cannot be added or multiplied; write them one after the other")
        return super().call_binop(context, operator, left, right)

    def is_safe_callable(self, obj: Any) -> bool:
        return not isinstance(getattr(obj, "__self__", None), Markup) and super().is_safe_callable(obj)


class _Unknown(StrictUndefined):
    """Undefined name in a template, with suggestions in its error message."""

    __slots__ = ()

    @property
    def _undefined_message(self) -> str:
        if self._undefined_hint:
            return self._undefined_hint
        name = str(self._undefined_name)
        if self._undefined_obj is not missing:
            return f'this value has no part "{name}"'
        return f'nothing is named "{name}"{suggestion_or(name, PAGE_NAMES, "there are " + ", ".join(PAGE_NAMES))}'


# Files of a report's figures in a folder beside the report.


def figure_folder(path: Path) -> Path:
    """Path of the folder with the figures of a report.

    ``rig_figures`` for ``rig.tex``, without characters a link cannot hold.

    >>> figure_folder(Path("gear V 100%.tex")).name
    'gear_V_100__figures'
    """
    return path.with_name(re.sub(r"[^A-Za-z0-9.-]", "_", path.stem) + "_figures")


def figures_beside(folder: str, form: str) -> Illustrations:
    """References of a text to the figures and images in a folder beside it."""
    return Illustrations(
        lambda picture, _: f"{folder}/{picture.name}.{form}", lambda name, _: f"{folder}/{_file(name)}"
    )


def _file(image: str) -> str:
    """File name of an image of the template folder beside the figures, none of which has such a name."""
    return f"template_{image}"


def write_beside(report: Report, path: Path, form: str, text: str) -> tuple[Path, ...]:
    """Write a text, every figure and the template's images in use, and return the paths of the files."""
    from torsionnet.plot.drawing.save import figure_bytes

    folder = figure_folder(path)
    images = report.template.images if report.template else {}
    files = {_file(name): data for name, data in images.items() if f"{folder.name}/{_file(name)}" in text}
    files |= {f"{picture.name}.{form}": figure_bytes(picture.figure, form) for picture in report.pictures}
    with _all_or_none(folder, files):
        for name, data in files.items():
            folder.mkdir(exist_ok=True)
            write_bytes(folder / name, data)
        write_text(path, text)
    return (path, *(folder / name for name in files))


@contextlib.contextmanager
def _all_or_none(folder: Path, names: Iterable[str]) -> Iterator[None]:
    """Delete the files that were written if one of them cannot be, as on a full disk."""
    new = [folder / name for name in names if not (folder / name).exists()]
    made = not folder.exists()
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError):
            for one in new:
                one.unlink(missing_ok=True)
            if made:
                folder.rmdir()
        raise
