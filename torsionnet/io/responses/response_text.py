"""CSV files: those written here, to the last digit, and tables of magnitude and phase."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import write_text
from torsionnet.core.errors import Fault, ModelError, Position
from torsionnet.io.records.early_end import ENOUGH, early_end
from torsionnet.io.responses.described import KEY, described, description, limit_in, words
from torsionnet.io.responses.matrix import Matrix, Single, resolve_units
from torsionnet.io.responses.response_headings import ColumnHeading, headings
from torsionnet.response import FrequencyResponse
from torsionnet.response.conventions import FREQUENCIES
from torsionnet.response.estimation import estimation_in
from torsionnet.response.frequency_response import SIGN_NOTE, FloatArray

_STORED = re.compile(rf"#\s*{KEY}:\s*(.*)")
SEPARATORS = (";", "\t", ",")
MOST_FAULTS = 20


def write(response: FrequencyResponse, path: Path) -> None:
    """A description, headings with units, real and imaginary parts of every pair, all digits."""
    columns: list[tuple[str, FloatArray]] = [("frequency [Hz]", response.frequencies)]
    for o, out in enumerate(response.outputs):
        for i, into in enumerate(response.inputs):
            label, unit = f"{out.name}/{into.name}", response.unit(o, i)
            values = response.values[:, o, i]
            columns += [(f"re {label} [{unit}]", values.real), (f"im {label} [{unit}]", values.imag)]
            if response.coherence is not None:
                columns.append((f"coherence {label} [1]", response.coherence[:, o, i]))
    if response.conditioning is not None:
        columns.append(("conditioning [1]", response.conditioning))
    buffer = io.StringIO()
    buffer.write(f"# {KEY}: {description(response)}\n")
    buffer.write(",".join(_quoted(name) for name, _ in columns) + "\n")
    rows = zip(*(np.asarray(values, dtype=float).tolist() for _, values in columns), strict=True)
    buffer.writelines(",".join(map(repr, row)) + "\n" for row in rows)
    write_text(path, buffer.getvalue())


def _quoted(name: str) -> str:
    name = " ".join(name.split())
    return '"' + name.replace('"', '""') + '"' if any(mark in name for mark in ',;"\t') else name


def read(path: Path) -> FrequencyResponse:
    """The response in a CSV file; ModelError lists every fault with its line."""
    content = path.read_text(encoding="utf-8-sig")
    lines, is_ended = content.splitlines(), content.endswith("\n")
    comments = [line for line in lines if line.startswith("#")]
    body = [(number, line) for number, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(body) < 2:
        place = Position(path.name, 1, 1, 1, lines[0][:200] if lines else "")
        raise ModelError([Fault("there are no rows of numbers below a heading", position=place)], path.name)
    number, heading = body[0]
    texts = [found[1] for comment in comments if (found := _STORED.match(comment))]
    if texts:  # the description has the names, whatever characters are in them
        names = next(csv.reader([heading]))
        if not is_ended:
            _check_end(body[1:], ",", names, path.name, own=True)
        kinds = [text.split(" ")[0] for text in names]
        return _own(texts[0], kinds, _numbers(body[1:], ",", len(kinds), path.name))
    separator = max(SEPARATORS, key=heading.count)
    columns = headings(heading, separator, Position(path.name, number, 1, 1, heading[:200]))
    if not is_ended:
        _check_end(body[1:], separator, next(csv.reader([heading], delimiter=separator)), path.name)
    numbers = _numbers(body[1:], separator, len(columns), path.name)
    return _foreign(columns, numbers, [comment[1:].strip() for comment in comments], path)


def _check_end(
    body: list[tuple[int, str]], separator: str, names: Sequence[str], file: str, *, own: bool = False
) -> None:
    rows = [[cell.strip().strip('"') for cell in line.split(separator)] for _, line in body[-1 - ENOUGH :]]
    text = early_end(rows[-1], rows[:-1], names, own=own)
    if text:
        number, line = body[-1]
        raise ModelError([Fault(text, position=Position(file, number, 1, len(line) + 1, line[:200]))], file)


def _numbers(body: list[tuple[int, str]], separator: str, width: int, file: str) -> FloatArray:
    faults: list[Fault] = []
    rows = np.full((len(body), width), np.nan)
    for row, (number, line) in enumerate(body):
        cells = line.split(separator)
        if len(cells) != width:
            faults.append(
                Fault(f"{len(cells)} cells under {width} headings", position=Position(file, number, 1, 1, line[:200]))
            )
            continue
        at = 1
        for column, cell in enumerate(cells):
            try:
                rows[row, column] = float(cell.strip().strip('"') or "nan")
            except ValueError:
                place = Position(file, number, at, at + len(cell), line[:200])
                comma = "; write numbers with a decimal point" if re.fullmatch(r"\s*-?\d+,\d+\s*", cell) else ""
                faults.append(Fault(f'expected a number, got "{cell.strip()}"{comma}', position=place))
            at += len(cell) + 1
    if faults:
        raise ModelError(faults[:MOST_FAULTS], file)
    return rows


def _own(text: str, kinds: list[str], numbers: FloatArray) -> FrequencyResponse:
    found = {kind: numbers[:, [at for at, other in enumerate(kinds) if other == kind]] for kind in dict.fromkeys(kinds)}
    said = words(text)
    shape = (len(numbers), len(said.outputs), len(said.inputs))
    values = np.empty(shape, dtype=complex)
    values.real, values.imag = found["re"].reshape(shape), found["im"].reshape(shape)
    whole: dict[str, Any] = {"frequencies": found["frequency"][:, 0], "values": values}
    if "coherence" in found:
        whole["coherence"] = found["coherence"].reshape(shape)
    if "conditioning" in found:
        whole["conditioning"] = found["conditioning"][:, 0]
    return described(text, whole)


def _foreign(columns: list[ColumnHeading], numbers: FloatArray, comments: list[str], path: Path) -> FrequencyResponse:
    frequency = columns[0]
    matrix = Matrix(numbers[:, 0] / FREQUENCIES[frequency.unit])
    parts: dict[tuple[str, str], dict[str, tuple[ColumnHeading, FloatArray]]] = {}
    for at, column in enumerate(columns):
        if column.pair is not None:
            parts.setdefault(column.pair, {})[column.kind] = (column, numbers[:, at])
    for pair, found in parts.items():
        matrix.pairs[pair] = _single(found)
    notes = resolve_units(matrix.pairs)
    kept = [comment for comment in comments[1:] if comment not in ("", SIGN_NOTE) and limit_in([comment]) is None]
    conditioning = [numbers[:, at] for at, column in enumerate(columns) if column.kind == "conditioning"]
    more = {
        "conditioning": conditioning[0] if conditioning else None,
        "usable_up_to": limit_in(comments),
        "estimation": estimation_in(comments),
        "has_phase": not any("phase" not in found and "re" not in found for found in parts.values()),
    }
    return matrix.response(path.name, comments[0] if comments else path.stem, (*kept, *notes), **more)


def _single(found: dict[str, tuple[ColumnHeading, FloatArray]]) -> Single:
    if "re" in found:
        heading, real = found["re"]
        values = np.empty(len(real), dtype=complex)
        values.real, values.imag = real, found["im"][1]
    else:
        heading, magnitude = found["magnitude"]
        phase = found["phase"][1] if "phase" in found else 0.0  # has_phase says which it is
        with np.errstate(invalid="ignore"):  # an infinite magnitude has no real part
            values = magnitude * np.exp(1j * np.radians(phase))
    coherence = found["coherence"][1] if "coherence" in found else None
    with np.errstate(invalid="ignore"):
        scaled = np.asarray(values / heading.scale, dtype=complex)
    return Single(scaled, heading.above, heading.below, coherence)
