"""Events of motion over time, as a contact that closes or a clutch that locks."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionEvent:
    """Change of the piece of a law of motion at a time in s.

    Attributes
    ----------
    time : float
        Time of the event in s.
    element : str
        Name of the element whose law changes its piece.
    what : str
        The change in words, as ``closes``, ``opens``, ``sticks``, ``slips``, ``stage 2``.

    Examples
    --------
    >>> str(MotionEvent(0.2873563, "clutch", "sticks"))
    '0.287356 s: clutch sticks'
    """

    time: float
    element: str
    what: str

    def __str__(self) -> str:
        return f"{self.time:.6g} s: {self.element} {self.what}"
