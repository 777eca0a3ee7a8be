"""Loading of a study from its file or from the library."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from torsionnet.base.entries.declared import version_faults
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.drivetrain import Drivetrain
from torsionnet.loading import load
from torsionnet.model.files.library import decode, library_models, library_studies
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.reader import located_faults, presentable_faults
from torsionnet.study.study import Study, study_of
from torsionnet.study.study_file import StudyEntries


def load_study(path: str | os.PathLike[str]) -> Study:
    """Load a study from a file, or from the library by its name, and return it.

    Parameters
    ----------
    path : str or path
        A file with ``model:``, ``vary:`` and ``quantities:``, or a name out of
        :func:`~torsionnet.model.files.library_studies`.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file or study.

    Examples
    --------
    >>> load_study("amt_tolerances").count
    16384
    """
    file = _find(path)
    document = _document(file)
    if not isinstance(document.data, dict):
        raise ModelError(located_faults([*document.faults, Fault("the file describes no study")], document), file.name)
    if "elements" in document.data and "vary" not in document.data:
        text = f"this is a model, no study; a study names it and what varies: model: {file.name}, vary: ..."
        raise ModelError(
            located_faults([*document.faults, Fault(text, ("elements",), on_key=True)], document), file.name
        )
    faults = [*document.faults, *version_faults(document.data, "study")]
    name = document.data.get("model")
    model, found = _model(str(name), file.parent) if isinstance(name, str) else (None, [])
    faults += found
    study, found = study_of(model, document.data) if model is not None else (None, StudyEntries.read(document.data)[1])
    faults += found
    errors = [fault for fault in faults if fault.severity == "error"]
    if errors or study is None:
        raise ModelError(located_faults(errors, document), file.name)
    return replace(study, findings=tuple(located_faults(faults, document)))


def _find(study: str | os.PathLike[str]) -> Path:
    known = library_studies()
    if isinstance(study, str):
        if study in known:
            return known[study]
        if not Path(study).suffix and not Path(study).exists():
            if study in library_models():
                raise UsageError(f'"{study}" is a model, no study; name it in a study file: model: {study}')
            hint = did_you_mean(study, known) or f"; the library has {', '.join(known)}"
            raise UsageError(f'no study is named "{study}"{hint}')
    return Path(study)


def _document(file: Path) -> LocatedDocument:
    try:
        return compose(decode(file.read_bytes(), str(file)).removeprefix("\ufeff"), str(file))
    except ModelError as error:
        raise ModelError(presentable_faults(error.faults), file.name) from None
    except OSError as error:
        raise UsageError(f"{file} cannot be read: {error.strerror or error}") from None


def _model(name: str, folder: Path) -> tuple[Drivetrain | None, list[Fault]]:
    """Model of a study by its name or path, None if it cannot be loaded, and faults with their places."""
    try:
        return load(folder / name if Path(name).suffix else name), []
    except UsageError as error:
        return None, [Fault(str(error), ("model",))]
    except ModelError as error:
        return None, [Fault(f"{name} has {len(error.faults)} errors", ("model",)), *error.faults]
