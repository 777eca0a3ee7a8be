"""Start of the explore page with a model file, also a faulty one, a library model, or a text without a file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from torsionnet.app.explore.choices import ResponseChoice
from torsionnet.app.explore.disk_file import disk_file
from torsionnet.app.explore.documents import Documents, TextSource
from torsionnet.app.explore.line_ends import plain_line_ends
from torsionnet.app.explore.session import open_session, read_overlay
from torsionnet.app.explore.session_remaking import SessionOptions
from torsionnet.base.errors import Fault
from torsionnet.model.files.library import decode, library_models
from torsionnet.model.files.reader import find_model, read_text

LIBRARY = "a library model is not changed; save the text as a file of your own and open that one"
"""Sentence on why a library model cannot be stored."""
NO_FILE = "this text has no file yet; save it as a file and open that one with torsionnet explore FILE"
"""Sentence on why a text without a file cannot be stored."""


def open_documents(
    model: str | os.PathLike[str] = "model.yaml",
    configuration: str = "",
    settings: Mapping[str, str] | None = None,
    pairs: Sequence[ResponseChoice] = (),
    band: tuple[float, float] | None = None,
    overlay: str | os.PathLike[str] | None = None,
    text: str | None = None,
    over_speed: Sequence[str] = (),
    measured: str | os.PathLike[str] | None = None,
    *,
    is_template: bool = False,
) -> tuple[Documents, list[Fault]]:
    """Documents of a page, and the faults of the model they begin with.

    Parameters are those of :func:`torsionnet.app.explore.open_session`. A model with errors is opened to be mended;
    what else was asked for is then left for when it is sound.

    Parameters
    ----------
    is_template : bool
        Whether the text is one to begin with.

    Raises
    ------
    ModelError
        The test is faulty, or the file is no text.
    UsageError
        A name that does not exist, a file that is missing.

    Examples
    --------
    >>> documents, faults = open_documents("amt_rig")
    >>> documents.open("tab")["can_save"], faults
    (False, [])
    """
    path = Path("model.yaml") if text is not None else find_model(model)
    folder = path.parent if text is None else None
    file, why_not = None, NO_FILE
    if text is None:
        is_own = path.resolve() not in {one.resolve() for one in library_models().values()}
        file, why_not = (disk_file(path), "") if is_own else (None, LIBRARY)
        text = decode(path.read_bytes(), str(path))
    shown = path.name if folder is None else str(model)
    source = TextSource(plain_line_ends(text), path.name, shown, file, why_not, is_template)
    definition, faults = read_text(text, str(path), folder)
    if definition is None:
        test = None if overlay is None else read_overlay(overlay)
        name, orders = "" if overlay is None else Path(overlay).name, None if measured is None else Path(measured)
        options = SessionOptions(
            str(model), path, folder, configuration, dict(settings or {}), tuple(pairs), band, test, name,
            tuple(over_speed), orders,
        )  # fmt: skip
        return Documents(options, source), faults
    session = open_session(
        model, configuration, settings, pairs, band, overlay, None if folder else text, over_speed, measured
    )
    session = replace(session, text=source.text)
    options = replace(SessionOptions.of(session), path=path, band=band)
    return Documents(options, source, session), list(session.base.check())
