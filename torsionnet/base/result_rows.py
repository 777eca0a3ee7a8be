"""Declarations of the fields of results, of which JSON, its schema, tables and files of them are made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torsionnet.base.entries.spec import Schema

NUMBER: Schema = {"type": ["number", "null"], "description": "null where it is infinite or not determined"}
NUMBERS: Schema = {"type": "array", "items": NUMBER}
NUMBER_ROWS: Schema = {"type": "array", "items": NUMBERS}
PAIR: Schema = {**NUMBERS, "minItems": 2, "maxItems": 2}
COMPLEX: Schema = {**PAIR, "description": "real and imaginary part"}


@dataclass(frozen=True)
class Out:
    """Declaration of how a field of a result is shown, as in ``Annotated[float, Out("natural frequency", "Hz")]``.

    Attributes
    ----------
    heading : str
        Of its column in tables and CSV; empty: it has none.
    unit : str
        Of the column.
    json : str or None
        Key in JSON; empty: the name of the field; None: it is left out.
    digits, decimals : int
        Significant digits of the column on the screen, and most decimals.
    factor : float
        Number in the column over the value of the field.
    after : str
        Field that this one follows in JSON and tables; empty: fields stand as declared, properties before them.
    optional : bool
        Whether JSON leaves the key out where the value is None.
    schema : mapping or None
        JSON Schema where the type of the field says less.
    unit_of : str
        Field with the SI unit of each row, where units differ from row to row; a text is that unit, as it is shown.
    """

    heading: str = ""
    unit: str = ""
    json: str | None = ""
    digits: int = 6
    decimals: int | None = None
    factor: float = 1.0
    after: str = ""
    optional: bool = False
    schema: Schema | None = None
    unit_of: str = ""
