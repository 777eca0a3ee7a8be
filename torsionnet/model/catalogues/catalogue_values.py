"""Entries of an element that come from a row of a catalogue, and the faults of those that cannot be taken."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from torsionnet.base.entries.declared import nearby_file
from torsionnet.base.entries.spec import EntryError, Spec
from torsionnet.base.errors import Fault, ModelError, got, nearest, question
from torsionnet.base.units import expected_unit
from torsionnet.model.catalogues.catalogue import Catalogue, CatalogueCell, CatalogueRow
from torsionnet.model.catalogues.catalogue_entries import CATALOGUE, SIZE

PACKAGE = Path(__file__).resolve().parents[2]
"""Folder of the package ``torsionnet``, from which its library of catalogues is found."""


def shipped_catalogues() -> dict[str, Path]:
    """Path of every catalogue that comes with the package, by name.

    >>> "example_couplings" in shipped_catalogues()
    True
    """
    installed = PACKAGE / "library"
    folder = installed if installed.is_dir() else PACKAGE.parent / "library"
    return {path.stem: path for path in sorted((folder / "catalogues").glob("*.csv"))}


def chosen_row(entries: Mapping[str, Any]) -> tuple[CatalogueRow | None, list[Fault]]:
    """Catalogue row that an element's ``catalogue`` and ``size`` name, None where they name none, and faults."""
    file, size = entries.get(CATALOGUE), entries.get(SIZE)
    if isinstance(file, CatalogueRow):
        return file, []
    if file is None:
        lone = Fault("a size is looked up in a catalogue; add catalogue: couplings.csv", (SIZE,), on_key=True)
        return None, [lone] if SIZE in entries else []
    if isinstance(file, Catalogue):
        return chosen_row({**entries, CATALOGUE: file.path})
    if not isinstance(file, str | Path):
        return None, [Fault(f"expected the name of a catalogue, as couplings.csv, {got(file)}", (CATALOGUE,))]
    if size is None:
        return None, [Fault("a catalogue needs the size that is meant, as size: A350", (CATALOGUE,), on_key=True)]
    from torsionnet.model.catalogues.catalogue_reading import catalogue_row

    try:
        path = file if isinstance(file, Path) else _path(file)
        return catalogue_row(path, path.name if path is file else str(file), str(size)), []
    except EntryError as error:
        return None, [fault.under(CATALOGUE) for fault in error.faults]
    except OSError as error:
        return None, [Fault(f"{file} cannot be read: {error.strerror or error}", (CATALOGUE,))]
    except ModelError as error:
        told = [] if any(fault.path for fault in error.faults) else [_useless(str(file), len(error.faults))]
        return None, [*told, *error.faults]


def _useless(file: str, count: int) -> Fault:
    return Fault(f"{file} cannot be used; {count} fault{'s' if count > 1 else ''} in it", (CATALOGUE,))


def _path(file: str) -> Path:
    shipped = shipped_catalogues()
    if file in shipped:
        return shipped[file]
    if not Path(file).suffix:
        meant = nearest(file, shipped)
        hint = question(meant) or f"; there are {', '.join(shipped)}"
        text = f'no catalogue that comes with the package is named "{file}"{hint} (a file ends in .csv)'
        raise EntryError(Fault(text, about=file, meant=meant))
    return nearby_file(file)


def row_entries(
    row: CatalogueRow, specs: Mapping[str, Spec[object]], given: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Fault]]:
    """Entries, by name, that a catalogue row gives and the model does not, and faults.

    ``loss_factor.psi`` is part of an entry.
    """
    found: dict[str, Any] = {}
    faults: list[Fault] = []
    for cell in row.cells:
        name, _, part = cell.column.partition(".")
        if name not in specs or name in (CATALOGUE, SIZE, "enabled") or name in given:
            continue
        if part:
            found.setdefault(name, {})[part] = cell.raw
        else:
            found[name] = cell_value(cell, specs[name], faults)
    return found, [*([_useless(row.file, len(faults))] if faults else []), *faults]


def entries_of_other_size(
    row: CatalogueRow, size: str, specs: Mapping[str, Spec[object]], stored: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Fault]]:
    """Entries of an element that change with another size of its catalogue.

    The row itself, and entries that still have the values of the old row.
    """
    from torsionnet.model.catalogues.catalogue_reading import catalogue_row

    try:
        new = catalogue_row(row.path, row.file, size)
    except ModelError as error:
        return {}, list(error.faults)
    before, _ = row_entries(row, specs, {})
    after, faults = row_entries(new, specs, {})
    kept = {name for name, raw in before.items() if specs[name].coerce(raw) != stored[name]}
    lacking = [name for name in before if name not in after and name not in kept]
    faults += [Fault(f"{row.file} has no {name} of size {size}, but of {row.size}", (SIZE,)) for name in lacking]
    return {CATALOGUE: new, **{name: raw for name, raw in after.items() if name not in kept}}, faults


def cell_value(cell: CatalogueCell, spec: Spec[object], faults: list[Fault]) -> Any:
    """Value of a catalogue cell as an entry takes it; a value that does not fit is added to ``faults``."""
    dimension = getattr(spec, "dimension", "1")
    if dimension != "1" and cell.is_number and not cell.has_unit:
        example = f"{cell.column} [{expected_unit(dimension)}]"
        text = f'the column "{cell.column}" has no unit; write its heading as {example}, in the unit it has'
        faults.append(Fault(text, position=cell.heading))
        return None
    raw: Any = cell.raw
    if not hasattr(spec, "dimension"):
        raw = {"true": True, "false": False}.get(raw.casefold(), int(raw) if raw.isdigit() else raw)
    try:
        spec.coerce(raw)
    except EntryError as error:
        faults.append(Fault(error.fault.message, position=cell.place))
    return raw
