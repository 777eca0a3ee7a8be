"""Averaging data of estimated responses in the notes of files that have no other place for them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from torsionnet.response import Estimation

_NOTE = re.compile(
    r"(?P<estimator>H\w+)( with .+?)?, Welch, (?P<window>\w+) (?P<seconds>\S+) s, overlap (?P<overlap>[\d.]+)%, "
    r"detrend (?P<detrend>\w+), (?P<averages>\d+) averages worth (?P<effective>[\d.]+)\b.*"
)


def estimation_in(notes: Iterable[str]) -> Estimation | None:
    """Averaging data of an estimated response, read from the text of notes, None if no note has them.

    >>> estimation_in(["H1, Welch, hann 8 s, overlap 75%, detrend mean, 21 averages worth 11.8 without"]).seconds
    8.0
    """
    for note in notes:
        found = _NOTE.fullmatch(note)
        if found:
            seconds, overlap, effective = (float(found[key]) for key in ("seconds", "overlap", "effective"))
            names = found["estimator"], found["window"]
            return Estimation(*names, seconds, overlap / 100, found["detrend"], int(found["averages"]), effective)
    return None
