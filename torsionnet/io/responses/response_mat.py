"""MAT v5 files: variables frequencies, values (n_f x n_out x n_in), names and units, ready for Matlab."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.core.atomic import write_bytes
from torsionnet.core.errors import Fault, ModelError
from torsionnet.io.foreign import Content, opening
from torsionnet.io.foreign.content import ROW
from torsionnet.io.mat_bytes import cells, mat_bytes
from torsionnet.io.responses.described import KEY, arrays, described, description
from torsionnet.response import FrequencyResponse

FLAT = ("frequencies", "conditioning")
NUMBERS = ("frequencies", "values", "coherence", "conditioning")


def read(path: Path) -> FrequencyResponse:
    """The response in a MAT file of :func:`write`."""
    with opening.opened(path, "mat") as content:
        names = [item.name for item in content.arrays]
        there = [*names, *content.attributes, *content.others]
        missing = [name for name in (KEY, "frequencies", "values") if name not in there]
        if missing:
            known = ", ".join(there) or "nothing"
            text = f"the file has no {', '.join(missing)}: no frequency response of torsionnet; it has {known}"
            raise ModelError([Fault(text)], path.name)
        found = {name: _values(content, names.index(name)) for name in NUMBERS if name in names}
        text = str(content.attributes.get(KEY, ""))
    numbers = {name: values.ravel() if name in FLAT else _cubic(values) for name, values in found.items()}
    return described(text, numbers | {"values": np.asarray(numbers["values"], dtype=complex)})


def _values(content: Content, number: int) -> Any:
    values = next(content.blocks([number], 0))[0]
    return values.T if content.arrays[number].attributes.get(ROW) else values


def _cubic(values: Any) -> Any:
    """Matlab drops a third dimension of one when it saves again."""
    return values if values.ndim == 3 else values[:, :, None]


def write(response: FrequencyResponse, path: Path) -> None:
    """Numbers, and cell arrays of names and units."""
    sides = {"output": response.outputs, "input": response.inputs}
    names = {f"{side}_names": cells(channel.name for channel in channels) for side, channels in sides.items()}
    units = {f"{side}_units": cells(channel.unit for channel in channels) for side, channels in sides.items()}
    values = np.asarray(response.values, dtype=complex)
    content = {**arrays(response), "values": values, **names, **units, "title": response.title}
    write_bytes(path, mat_bytes({**content, KEY: description(response)}))
