"""Files of a report's figures in a folder beside the report."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from torsionnet.base.atomic import write_bytes, write_text
from torsionnet.report.document_tree import Report
from torsionnet.report.writers.templating import Illustrations


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
    from torsionnet.plot.drawing.rendering import figure_bytes

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
