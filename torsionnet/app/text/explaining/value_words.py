"""Words on values in a model text: as written, in SI units, and what an expression gives."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from torsionnet.app.text.naming.mentions import Scope
from torsionnet.base.entries.scalars import plain_scalar
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.number_text import screen_text
from torsionnet.base.units import DIMENSIONS, Dimension, expected_unit

_MARKS = re.compile(r"([\\`*_<>\[\]])")


def prose(text: object) -> str:
    """Free text of a model in one line of Markdown, in which its own signs mean nothing."""
    return _MARKS.sub(r"\\\1", " ".join(str(text).split()))


def code(text: object) -> str:
    """Text of a model as it is written, for a line of Markdown."""
    return f"`{' '.join(str(text).replace('`', chr(39)).split())}`"


class KnownValues:
    """Values of the parameters of a model or part as far as they can be read, in SI units."""

    def __init__(self, scope: Scope) -> None:
        from torsionnet.model.sections import PARAMETERS

        self.parameters = dict(PARAMETERS.read(scope.table("parameters"))[0])

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter in SI units, by name."""
        from torsionnet.model.parameters import resolve

        return resolve(self.parameters)[0]

    @cached_property
    def dimensions(self) -> Mapping[str, Dimension | None]:
        """Dimension of each parameter, by name; None where it is a bare number."""
        from torsionnet.model.parameters import dimensions

        return dimensions(self.parameters)[0]

    def in_si(self, value: Expression, dimension: str = "") -> str:
        """Value of an expression with its SI unit; empty where a parameter in it has no value."""
        try:
            number = float(value.evaluate(self.values))
            found = DIMENSIONS[dimension] if dimension else value.dimension(self.dimensions)
        except (TorsionnetError, ArithmeticError, TypeError):
            return ""
        if not dimension and found == DIMENSIONS["torque"] and _is_per_angle(value):
            dimension = "stiffness"
        unit = expected_unit(dimension) if dimension else "" if found is None else str(found)
        return f"{screen_text(number)} {unit}".strip() if unit != "1" else screen_text(number)

    def words(self, value: Expression, dimension: str = "") -> str:
        """Words on an expression: as written, what it is in SI units, and the parameters in it."""
        written, now = str(plain_scalar(value)), self.in_si(value, dimension)
        text = code(written)
        if now and now != written:
            text += f" = {now}"
        elif not now and not isinstance(value, Number):
            text += ", which has no value yet"
        known = [name for name in sorted(value.names) if name in self.parameters]
        if known and written not in known:
            shown = (f"{code(name)} = {self.in_si(self.parameters[name].value) or '?'}" for name in known)
            text += f"\n\nwith {', '.join(shown)}"
        return text


def _is_per_angle(value: Expression) -> bool:
    """Whether a value is written per angle, which counts as 1 in dimensions."""
    return isinstance(value, Number) and value.has_angle
