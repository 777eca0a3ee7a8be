"""Datasets 58 (functions) of universal files, read and written through pyuff."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torsionnet.base.atomic import atomic_replacement
from torsionnet.signals.formats.extras import import_extra

FUNCTION_DATASET, UNITS_DATASET = 58, 164
"""Numbers of the types of datasets in universal files that hold a function, and the units of what follows."""
GENERAL_FUNCTION, TIME_RESPONSE, FRF, TRANSMISSIBILITY, COHERENCE = 0, 1, 4, 5, 6
"""Codes of the types of functions in dataset 58 (record 6, field 1)."""
ROTATION_ABOUT_X = 4
"""Code of a rotation about +X as a direction in dataset 58 (record 6, fields 7 and 10), negative about -X."""
ROTATIONS = frozenset({4, 5, 6})
"""Codes of rotations about X, Y and Z as directions in dataset 58 (record 6, fields 7 and 10)."""
TRANSLATIONS = frozenset({1, 2, 3})
"""Codes of translations along X, Y and Z as directions in dataset 58 (record 6, fields 7 and 10)."""
GENERAL, TIME_AXIS, FREQUENCY_AXIS = 1, 17, 18
"""Codes of data types in dataset 58 of values in general, and of an abscissa of times and of frequencies."""
ABSCISSAE = {8: "a displacement", TIME_AXIS: "time", FREQUENCY_AXIS: "frequency", 19: "a speed in rpm", 20: "an order"}
"""Words for the codes of data types that the abscissa of a dataset 58 has."""
FUNCTIONS = {
    0: "functions of no known kind", TIME_RESPONSE: "records over time", 2: "auto spectra", 3: "cross spectra",
    FRF: "frequency responses", TRANSMISSIBILITY: "transmissibilities", COHERENCE: "coherences",
    7: "auto correlations", 8: "cross correlations", 9: "power spectral densities", 10: "energy spectral densities",
    12: "spectra", 17: "orbits", 18: "mode indicator functions", 24: "shock response spectra",
}  # fmt: skip
"""Words for the types of functions in dataset 58."""
CONTENTS = {
    15: "nodes of a mesh", 781: "nodes of a mesh", 2411: "nodes of a mesh", 71: "elements of a mesh",
    780: "elements of a mesh", 2412: "elements of a mesh", 82: "lines of a mesh", 2431: "lines of a mesh",
    18: "coordinate systems", 2420: "coordinate systems", 55: "mode shapes or results at nodes",
    2414: "mode shapes or results at nodes", 2400: "a header", 2429: "groups of nodes", 2467: "groups of nodes",
}  # fmt: skip
"""Words for what datasets of universal files hold, by their types; headers and units are left out."""
ID_LINE_WIDTH = 80
"""Most characters of an ID line in dataset 58."""
PAIR_SEPARATOR = " / "
"""Text between the names of output and input in the first ID line of dataset 58."""

DATA_TYPES = {"rad": 8, "rad/s": 11, "rad/s^2": 12, "N*m": 13, "Pa": 2}
"""Codes of data types by SI unit in dataset 58 (records 9, 10, field 1), for rotation, its rates, torque, stress."""
UNITS = {code: unit for unit, code in DATA_TYPES.items()} | {9: "N*m"}
"""SI unit by code of a data type in dataset 58 where the file gives no label, the code 9 being a reaction torque."""
_EMPTY = ("", "NONE")
"""Texts of an ID line in dataset 58 that stand for an empty one."""
_UNUSED = {
    f"{axis}_{entry}": 0
    for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
    for entry in ("spec_data_type", "len_unit_exp", "force_unit_exp", "temp_unit_exp")
} | {"z_axis_value": 0.0, "orddenom_axis_units_lab": "NONE", "z_axis_axis_units_lab": "NONE"}


@dataclass(frozen=True)
class FileUnits:
    """Units of a universal file by its dataset 164: how many of its units of length and force are in a m and a N."""

    length: float = 1.0
    force: float = 1.0
    name: str = ""

    @property
    def factors(self) -> dict[str, float]:
        """Factors to SI by quantity, of those that are not 1."""
        every = {"torque": 1 / (self.length * self.force), "stress": self.length**2 / self.force}
        return {quantity: factor for quantity, factor in every.items() if factor != 1.0}


def units_of_datasets(sets: Sequence[Mapping[str, Any]]) -> list[FileUnits]:
    """Units that hold for every dataset of a universal file, by the dataset 164 before it."""
    found, now = [], FileUnits()
    for entries in sets:
        if entries.get("type") == UNITS_DATASET:
            length, force = (float(entries.get(key) or 1.0) for key in ("length", "force"))
            now = FileUnits(length, force, text_in(entries, "units_description"))
        found.append(now)
    return found


def abscissa_over(entries: Mapping[str, Any], kind: int) -> str:
    """Words for the abscissa of a dataset 58 that has no unit and a code other than ``kind``; else empty."""
    code = int(entries.get("abscissa_spec_data_type") or 0)
    if text_in(entries, "abscissa_axis_units_lab") or code in (0, GENERAL, kind):
        return ""
    return ABSCISSAE.get(code, f"an abscissa of type {code}")


def function_dataset(lines: Iterable[str], **entries: Any) -> dict[str, Any]:
    """Entries of a binary dataset 58 in double precision, with its five lines of text."""
    texts = {f"id{at}": " ".join(line.split())[:ID_LINE_WIDTH] or "NONE" for at, line in enumerate(lines, 1)}
    return {**_UNUSED, "type": FUNCTION_DATASET, "binary": 1, "load_case_id": 0, **texts, **entries}


def contents_of(sets: Sequence[Mapping[str, Any]]) -> str:
    """Words for what the datasets of a universal file hold.

    >>> contents_of([{"type": 164}, {"type": 15}, {"type": 58, "func_type": 9}, {"type": 58, "func_type": 9}])
    'nodes of a mesh (data set 15) and 2 power spectral densities (58)'
    """
    counts = Counter[tuple[int, str]]()
    for item in sets:
        kind = int(item.get("type") or 0)
        if kind == FUNCTION_DATASET:
            counts[kind, FUNCTIONS.get(int(item.get("func_type") or 0), FUNCTIONS[0])] += 1
        elif kind in CONTENTS:
            counts[kind, CONTENTS[kind]] = 0
    words = [f"{count} {words} ({kind})" if count else f"{words} ({kind})" for (kind, words), count in counts.items()]
    listed = " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]])) or "neither records nor responses"
    return listed.replace(" (", " (data set ", 1)


def text_in(entries: Mapping[str, Any], key: str) -> str:
    """Text of an entry of a dataset 58, empty where there is none."""
    line = str(entries.get(key) or "").strip()
    return "" if line in _EMPTY else line


def write_sets(sets: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write datasets one behind the other into a universal file, whole or not at all."""
    pyuff = import_extra("uff")
    with atomic_replacement(path) as temporary, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        temporary.unlink()  # pyuff would add to the empty file as if it had an end of a dataset
        for item in sets:
            try:
                pyuff.UFF(str(temporary)).write_sets(item, mode="add")
            except Exception as error:
                if isinstance(error.__context__, OSError):  # pyuff hides that the disk is full
                    raise error.__context__ from error
                raise
