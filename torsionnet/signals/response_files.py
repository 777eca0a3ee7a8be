"""Reading and writing of frequency responses in files, in the format of the ending."""

from __future__ import annotations

import os
from pathlib import Path

from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.signals.formats.registry import format_of, reading


def read_frequency_response(path: str | os.PathLike[str]) -> FrequencyResponse:
    """Read a frequency response from a file, values in SI over frequencies in Hz.

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
    with reading(source, "frequency response") as form:
        assert form.read_response is not None
        return form.read_response(source)


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
    write = format_of(target, "frequency response").write_response
    assert write is not None
    write(response, target)
