"""The ``report:`` section of a model file as typed values."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from torsionnet.core.errors import UsageError
from torsionnet.core.expressions import Number
from torsionnet.model.elements.fields import FieldError, read_scalar

_BAND = re.compile(r"\s*([-+\d.eE]+?)\s*([A-Za-z/]*)\s*\.\.\s*([-+\d.eE]+)\s*([A-Za-z/]*)\s*")
BAND_FORMS = "0.3..40 Hz or [0.3 Hz, 40 Hz]"


@dataclass(frozen=True)
class Pair:
    """A transfer function: output over input, and what drives if the input is measured.

    Examples
    --------
    >>> Pair.parse("theta_1/T_T")
    Pair(output='theta_1', input='T_T', excitation='')
    >>> print(Pair.parse("torque(gearbox, output_shaft) / T_M"))
    torque(gearbox, output_shaft)/T_M
    """

    output: str
    input: str
    excitation: str = ""

    @classmethod
    def parse(cls, text: str) -> Pair:
        """The pair meant by ``OUTPUT/INPUT``.

        Raises
        ------
        UsageError
            There is not exactly one ``/`` with a name on either side.
        """
        parts = [part.strip() for part in text.split("/")]
        if len(parts) != 2 or not all(parts):  # noqa: PLR2004
            msg = f'a transfer function is written OUTPUT/INPUT, as in theta_1/T_T; got "{text}"'
            raise UsageError(msg)
        return cls(*parts)

    def __str__(self) -> str:
        return f"{self.output}/{self.input}"

    def to_data(self) -> str | dict[str, str]:
        if not self.excitation:
            return str(self)
        return {"output": self.output, "input": self.input, "excitation": self.excitation}


@dataclass(frozen=True)
class ReportPlan:
    """What a report holds beside the model itself; what is empty is left to the default.

    Attributes
    ----------
    title, author, notes : str
    sections : tuple of str
        Names out of :data:`torsionnet.model.report.SECTIONS`.
    transfer_functions : tuple of Pair
    configurations : tuple of str
    band : (float, float), optional
        Hz; frequencies of the Bode plots.
    angle : {"rad", "deg"}
    """

    title: str = ""
    author: str = ""
    notes: str = ""
    sections: tuple[str, ...] = ()
    transfer_functions: tuple[Pair, ...] = ()
    configurations: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    angle: str = "rad"

    def to_data(self) -> dict[str, Any]:
        """The ``report:`` section that makes this outline."""
        data: dict[str, Any] = {key: getattr(self, key) for key in ("title", "author") if getattr(self, key)}
        data |= {key: list(getattr(self, key)) for key in ("sections", "configurations") if getattr(self, key)}
        if self.transfer_functions:
            data["transfer_functions"] = [pair.to_data() for pair in self.transfer_functions]
        if self.band:
            data["band"] = "..".join(repr(edge).removesuffix(".0") for edge in self.band) + " Hz"
        if self.angle != "rad":
            data["angle"] = self.angle
        return data | ({"notes": self.notes} if self.notes else {})


LOWEST, HIGHEST = 1e-9, 1e9
"""Hz; no shaft train moves slower or faster."""


def parse_band(raw: Any) -> tuple[float, float]:
    """Two frequencies in Hz from ``0.3..40 Hz`` or a list of two.

    >>> parse_band("18..2400 cpm"), parse_band(["0.3 Hz", 40])
    ((0.3, 40.0), (0.3, 40.0))
    """
    low, high = (_hertz(edge) for edge in _edges(raw))
    if not 0 < low < high:
        msg = f"a band goes from a lower to a higher frequency, both above 0, as in {BAND_FORMS}; got {raw!r}"
        raise FieldError(msg)
    if not LOWEST <= low < high <= HIGHEST:
        msg = f"a band lies between {LOWEST:g} and {HIGHEST:g} Hz, got {raw!r}"
        raise FieldError(msg)
    return low, high


def _edges(raw: Any) -> tuple[Any, Any]:
    if isinstance(raw, (list, tuple)) and len(raw) == 2:  # noqa: PLR2004
        return raw[0], raw[1]
    match = _BAND.fullmatch(raw) if isinstance(raw, str) else None
    if match is None:
        msg = f"expected a band such as {BAND_FORMS}, got {raw!r}"
        raise FieldError(msg)
    unit = match[4] or "Hz"
    return f"{match[1]} {match[2] or unit}", f"{match[3]} {unit}"


def _hertz(raw: Any) -> float:
    value = read_scalar(raw, "frequency")
    if not isinstance(value, Number):
        msg = f"a band is given by numbers with units, not by expressions such as {raw!r}"
        raise FieldError(msg)
    return float(value.value)
