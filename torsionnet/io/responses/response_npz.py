"""NPZ files of numpy."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np

from torsionnet.core.atomic import write_bytes
from torsionnet.core.errors import Fault, ModelError
from torsionnet.io.records.npz_headers import checked_headers, loaded
from torsionnet.io.responses.described import KEY, arrays, described, description
from torsionnet.response import FrequencyResponse

NUMBERS = ("frequencies", "values", "coherence", "conditioning")


def read(path: Path) -> FrequencyResponse:
    """The response in an NPZ file of :func:`write`."""
    with zipfile.ZipFile(path) as archive:
        there = checked_headers(archive, path)
        missing = [name for name in (KEY, "frequencies", "values") if name not in there]
        if missing:
            words = f"it has {', '.join(there)}" if there else "it is empty"
            text = f"the archive has no {', '.join(missing)}: no frequency response of torsionnet; {words}"
            raise ModelError([Fault(text)], path.name)
        return described(str(loaded(archive, KEY)), {name: loaded(archive, name) for name in NUMBERS if name in there})


def write(response: FrequencyResponse, path: Path) -> None:
    """An archive of arrays; equal responses give equal bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, values in {**arrays(response), KEY: np.array(description(response))}.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(values), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member.getvalue())  # dated 1980, not today
    write_bytes(path, buffer.getvalue())
