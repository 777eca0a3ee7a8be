"""MAT v5 files: variables frequencies, values (n_f x n_out x n_in), names and units, ready for Matlab."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.atomic import write_bytes
from torsionnet.errors import Fault, ModelError
from torsionnet.interchange.mat_bytes import cells, mat_bytes
from torsionnet.interchange.responses.described import KEY, arrays, described, description
from torsionnet.response import FrequencyResponse


def read(path: Path) -> FrequencyResponse:
    """The response in a MAT file of :func:`write`."""
    from scipy.io import loadmat

    content: dict[str, Any] = loadmat(str(path))
    missing = [name for name in (KEY, "frequencies", "values") if name not in content]
    if missing:
        there = ", ".join(name for name in content if not name.startswith("__")) or "nothing"
        text = f"the file has no {', '.join(missing)}: no frequency response of torsionnet; it has {there}"
        raise ModelError([Fault(text)], path.name)
    # Matlab drops a third dimension of one when it saves again.
    values = np.asarray(content["values"], dtype=complex)
    numbers = {"frequencies": content["frequencies"].ravel().astype(float), "values": _cubic(values)}
    if "coherence" in content:
        numbers["coherence"] = _cubic(content["coherence"].astype(float))
    if "conditioning" in content:
        numbers["conditioning"] = content["conditioning"].ravel().astype(float)
    return described("".join(content[KEY].ravel()[:1]), numbers)


def _cubic(values: Any) -> Any:
    return values if values.ndim == 3 else values[:, :, None]  # noqa: PLR2004


def write(response: FrequencyResponse, path: Path) -> None:
    """Numbers, and cell arrays of names and units."""
    sides = {"output": response.outputs, "input": response.inputs}
    names = {f"{side}_names": cells(channel.name for channel in channels) for side, channels in sides.items()}
    units = {f"{side}_units": cells(channel.unit for channel in channels) for side, channels in sides.items()}
    values = np.asarray(response.values, dtype=complex)
    content = {**arrays(response), "values": values, **names, **units, "title": response.title}
    write_bytes(path, mat_bytes({**content, KEY: description(response)}))
