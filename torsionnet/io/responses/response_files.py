"""Frequency responses from and into files, by the ending."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import Any

from torsionnet.core.errors import Fault, ModelError, TorsionnetError, UsageError, did_you_mean
from torsionnet.response import FrequencyResponse

MODULES = {".csv": "text", ".npz": "npz", ".mat": "mat", ".uff": "uff", ".unv": "uff"}
LABELS = {"text": "CSV", "npz": "NPZ", "mat": "MAT", "uff": "UFF58"}


def read_frequency_response(path: str | os.PathLike[str]) -> FrequencyResponse:
    """Read a frequency response, in SI units.

    Parameters
    ----------
    path : str or path
        A file ending in .csv, .npz, .mat, or with the extra ``uff`` in .uff or .unv. A CSV file may be one of
        :func:`write_frequency_response`, of :meth:`FrequencyResponse.to_csv` or of ``torsionnet frf --csv``: columns
        ``frequency [Hz]``, ``|output/input| [rad/(N*m)]`` and ``phase output/input [deg]``, or ``re`` and ``im``;
        magnitudes may stand alone, as published curves do.

    Returns
    -------
    FrequencyResponse
        ``values`` of shape (n_f, n_out, n_in); what had to be assumed is in its notes.

    Raises
    ------
    ModelError
        The file is faulty; everything found is listed, with its place.
    UsageError
        There is no such file, or its ending is not known.
    MissingExtraError
        The package for the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import torsionnet as tn
    >>> path = Path(tempfile.mkdtemp(), "frf.csv")
    >>> _ = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [1.0, 2.0]).to_csv(path)
    >>> read_frequency_response(path)
    <FrequencyResponse theta_1 / T_T: 2 frequencies, 1 to 2 Hz>
    """
    source = Path(path)
    label, module = _format_of(source)
    if not source.is_file():
        raise UsageError(f'there is no file "{source}"')
    try:
        response: FrequencyResponse = module.read(source)
    except TorsionnetError:
        raise
    # A library says of a damaged file what it likes: struct.error, zlib.error, IndexError.
    except Exception as error:
        said = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ModelError([Fault(f"the file cannot be read as {label}: {said}")], source.name) from error
    return response


def write_frequency_response(response: FrequencyResponse, path: str | os.PathLike[str]) -> None:
    """Write a frequency response in the format of the ending of ``path``, whole or not at all.

    Reading the file again gives the same names, units, frequencies, values, coherence and notes, to the last digit.
    UFF58 files take finite values only; they keep two notes, first the one on how it was estimated, and of these and
    the title what fits into lines of 80 characters.

    Raises
    ------
    UsageError
        The ending is not known, or the format cannot hold this response.
    MissingExtraError
        The package for the format is not installed.

    Examples
    --------
    >>> import tempfile
    >>> import torsionnet as tn
    >>> path = Path(tempfile.mkdtemp(), "frf.npz")
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1.0, 7.0, 80.0])
    >>> write_frequency_response(response, path)
    >>> bool((read_frequency_response(path).values == response.values).all())
    True
    """
    target = Path(path)
    _, module = _format_of(target)
    module.write(response, target)


def _format_of(path: Path) -> tuple[str, Any]:
    ending = path.suffix.lower()
    if ending not in MODULES:
        known = ", ".join(MODULES)
        hint = did_you_mean(ending, MODULES)
        raise UsageError(
            f'"{path.name}" has no ending of a frequency response{hint}; expected one of {known}'.replace("?;", "?")
        )
    name = MODULES[ending]
    return LABELS[name], importlib.import_module(f"torsionnet.io.responses.response_{name}")
