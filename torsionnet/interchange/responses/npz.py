"""NPZ files of numpy."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np

from torsionnet.atomic import write_bytes
from torsionnet.errors import Fault, ModelError
from torsionnet.interchange.responses.described import KEY, arrays, described, description
from torsionnet.response import FrequencyResponse

NUMBERS = ("frequencies", "values", "coherence", "conditioning")


def read(path: Path) -> FrequencyResponse:
    """The response in an NPZ file of :func:`write`."""
    with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        missing = [name for name in (KEY, "frequencies", "values") if name not in archive]
        if missing:
            there = f"it has {', '.join(archive.files)}" if archive.files else "it is empty"
            text = f"the archive has no {', '.join(missing)}: no frequency response of torsionnet; {there}"
            raise ModelError([Fault(text)], path.name)
        return described(str(archive[KEY]), {name: archive[name] for name in NUMBERS if name in archive})


def write(response: FrequencyResponse, path: Path) -> None:
    """An archive of arrays; equal responses give equal bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, values in {**arrays(response), KEY: np.array(description(response))}.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(values), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member.getvalue())  # dated 1980, not today
    write_bytes(path, buffer.getvalue())
