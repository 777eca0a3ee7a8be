"""Rendering of a report through the Jinja templates of one format; all text passes the format's own function.

A page of a template folder replaces blocks of the page that is shipped. It sees text only, nothing of the model or the
program, and runs in Jinja's sandbox.
"""

from __future__ import annotations

import contextlib
import re
import traceback
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

from jinja2 import Environment, FunctionLoader, StrictUndefined, TemplateError, TemplateRuntimeError, UndefinedError
from jinja2.sandbox import ImmutableSandboxedEnvironment
from jinja2.utils import missing
from markupsafe import Markup

from torsionnet.base.atomic import write_bytes, write_text
from torsionnet.base.errors import Fault, suggestion_or
from torsionnet.report.document_tree import Inline, Picture, Report
from torsionnet.report.wording import STYLE, TemplateFolder, TemplateFolderError
from torsionnet.report.writers.blocks import BlockWriter

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


class PageWriter(BlockWriter):
    """Writer of a format whose page is a template, into which the blocks are put.

    Attributes
    ----------
    ending : str
        Of the template ``page``.
    images : tuple of str
        Endings of the images that the format can show.
    """

    ending: ClassVar[str]
    images: ClassVar[tuple[str, ...]]

    def __init__(self, report: Report) -> None:
        self.report, self.template = report, report.template or TemplateFolder()
        super().__init__(self.template.wording)

    @abstractmethod
    def image(self, name: str, data: bytes, /) -> str:
        """Image of the template folder, as what follows ``src=`` or stands in ``\\includegraphics``."""

    def shown(self, value: Any) -> Markup:
        """Text of a value that a template inserts; what a writer has made is text of the format already."""
        if isinstance(value, Markup):
            return value
        return Markup(self.inline(value if isinstance(value, Inline | tuple) else str(value)))

    def page(self) -> str:
        """Text of the whole report."""
        report, template = self.report, self.template
        environment = environment_of(self.ending, template, self.shown)
        given = {
            "title": report.title,
            "subtitle": report.subtitle,
            "author": report.author,
            "date": report.date,
            "notes": self.shown(report.notes) if any(report.notes) else "",
            "title_block": Markup(self.title_block(report.title_block)) if report.title_block else "",
            "facts": Markup(self.facts(report.facts.rows)),
            "contents": [{"name": section.name, "title": self.shown(section.title)} for section in report.sections],
            "sections": Markup(self.blocks(report.sections)),
            "language": template.language,
            "word": template.wording,
            "image": lambda name: Markup(self.image(name, _image(template, name, self.images))),
            "style": Markup((SHIPPED / STYLE).read_text(encoding="utf-8") + template.texts.get(STYLE, "")),
        }
        try:
            return environment.get_template(f"page{self.ending}").render(given)
        except _WRONG as error:
            raise _located(error, template, f"page{self.ending}") from None


class BesideWriter(PageWriter):
    """Writer of a format whose figures and images are files in a folder beside it, figures in the format ``form``."""

    form: ClassVar[str]

    def __init__(self, report: Report, folder: str) -> None:
        super().__init__(report)
        self.folder = folder

    def drawing(self, picture: Picture) -> str:
        """Path of a figure."""
        return f"{self.folder}/{picture.name}.{self.form}"

    def image(self, name: str, _data: bytes) -> str:
        return f"{self.folder}/{_file(name)}"

    @classmethod
    def write(cls, report: Report, path: Path) -> tuple[Path, ...]:
        """Write a report with every figure and the template's images in use, and return the paths of the files."""
        from torsionnet.plot.drawing.save import figure_bytes

        folder = figure_folder(path)
        text = cls(report, folder.name).page()
        images = report.template.images if report.template else {}
        files = {_file(name): data for name, data in images.items() if f"{folder.name}/{_file(name)}" in text}
        files |= {f"{picture.name}.{cls.form}": figure_bytes(picture.figure, cls.form) for picture in report.pictures}
        with _all_or_none(folder, files):
            for name, data in files.items():
                folder.mkdir(exist_ok=True)
                write_bytes(folder / name, data)
            write_text(path, text)
        return (path, *(folder / name for name in files))


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


def _image(template: TemplateFolder, name: Any, endings: tuple[str, ...]) -> bytes:
    if name not in template.images:
        there = f"there are: {', '.join(template.images) or 'none'}"
        raise UndefinedError(f'no image is named "{name}"{suggestion_or(str(name), template.images, there)}')
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
    kind = "unknown-name" if isinstance(error, UndefinedError) else "wrong-form"
    return TemplateFolderError([Fault(text, position=place, kind=kind)], str(template.path))


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


def _file(image: str) -> str:
    """File name of an image of the template folder beside the figures, none of which has such a name."""
    return f"template_{image}"


@contextlib.contextmanager
def _all_or_none(folder: Path, names: Iterable[str]) -> Iterator[None]:
    """Delete the files that were written if one of them cannot be, as on a full disk."""
    new = [folder / name for name in names if not (folder / name).exists()]
    made = not folder.exists()
    try:
        yield
    except BaseException:
        with contextlib.suppress(OSError):
            for path in new:
                path.unlink(missing_ok=True)
            if made:
                folder.rmdir()
        raise
