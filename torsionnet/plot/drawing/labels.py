"""Texts of a schematic with the main values of an element, in engineering units."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import Spec, spec_of
from torsionnet.base.expressions import Name
from torsionnet.base.number_text import NumberText, prefix_of, typeset_unit
from torsionnet.base.phrases import phrase
from torsionnet.base.units import expected_unit
from torsionnet.model.damping import MEASURES, DampingMeasure
from torsionnet.model.element_base.element_entries import Teeth
from torsionnet.model.element_base.spring_stages import SpringStages
from torsionnet.model.element_base.stiffness_table import TableEntry
from torsionnet.model.elements import Element
from torsionnet.symbolic.symbol_names import GREEK

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
MOST_LINES = 3
"""Largest number of lines of values below the name of an element in a schematic; more would crowd the drawing."""
LONGEST_SYMBOL = 14
"""Largest number of letters of a name that is set as a symbol in mathtext; a longer one may have to be broken, which
mathtext cannot be."""

LONGEST_EXPRESSION = 14
"""Largest number of characters of a ratio's expression that a schematic shows before the value; of a longer one only
the value."""
STATES = ("state", "engaged")
"""Names of the entries of elements whose word a schematic shows as it is, as "slipping" of a clutch."""


@lru_cache(maxsize=4096)
def symbol(name: str) -> str:
    r"""Text of a name, set as mathtext if the name is a symbol: one letter or a Greek one, perhaps with an index.

    >>> symbol("k_1"), symbol("tau"), symbol("speed")
    ('$k_{\\mathrm{1}}$', '$\\tau$', 'speed')
    """
    match = re.fullmatch(r"([A-Za-z][A-Za-z0-9]*)(?:_(\w+))?", name)
    if match is None or len(name) > LONGEST_SYMBOL:
        return name
    base, below = match[1], match[2]
    if len(base) > 1 and base not in GREEK:
        return name
    shown = base if len(base) == 1 else f"\\{base}"
    escaped = (below or "").replace("_", r"\_")
    return f"${shown}_{{\\mathrm{{{escaped}}}}}$" if below else f"${shown}$"


@lru_cache(maxsize=4096)
def quantity(value: float, dimension: str) -> str:
    """Text of an SI value with its unit, with a prefix for large torques and stiffnesses.

    >>> quantity(13300.0, "stiffness"), quantity(0.05, "length")
    ('13.3 kN·m/rad', '50 mm')
    """
    unit = expected_unit(dimension)
    if unit in ("1", ""):
        return str(NumberText(value))
    if unit == "m" and abs(value) < 1:
        return f"{NumberText(1000 * value)} mm"
    prefix, factor = prefix_of(unit, value)
    if unit.startswith("Pa") or unit == "N":
        factor, prefix = next(((f, p) for f, p in PREFIXES if abs(value) >= f), (1.0, ""))
    return f"{NumberText(value / factor)} {prefix}{typeset_unit(unit)}"


def value_lines(element: Element, values: Mapping[str, Any]) -> list[str]:
    """List of the texts with the main values of an element, one text to a line; zeros are left out."""
    if element.kind == "shaft":
        return _shaft_lines(element, values)
    given = element.scalars()
    spec, counts = given.get("teeth", (None, None))
    first = [_ratio_line(element, counts)] if isinstance(spec, Teeth) and counts else []
    first += [raw for field, (_, raw) in given.items() if field in STATES]
    stages = [raw for spec, raw in given.values() if isinstance(spec, SpringStages)]
    first += [
        f"{symbol(f'k_{number}')} = {quantity(float(stage.stiffness.evaluate(values)), 'stiffness')}"
        for some in stages
        for number, stage in enumerate(some, 1)
    ]
    lines = [
        _line(spec, raw, values) for field, (spec, raw) in given.items() if not field.startswith(("planet", "orbit"))
    ]
    most = MOST_LINES + element.has_motion_laws  # the gap or the stages of a law of motion beside its k and c
    return [line for line in (*first, *lines) if line][:most]


def _line(spec: Spec[object], raw: Any, values: Mapping[str, Any]) -> str:
    if isinstance(spec, TableEntry):
        return "k(f), c(f)"
    if not isinstance(spec, QuantityKind):
        return ""
    if isinstance(raw, DampingMeasure):
        at = (
            "" if raw.at is None else phrase(" at {frequency} Hz", frequency=NumberText(float(raw.at.evaluate(values))))
        )
        dimension = MEASURES[raw.measure].dimension
        shown = quantity(float(raw.value.evaluate(values)), dimension)
        return f"{symbol(MEASURES[raw.measure].symbol)} = {shown}{at}"
    value = float(raw.evaluate(values))
    if value == 0:
        return ""
    if spec.dimension == "1" and raw.names and not isinstance(raw, Name) and len(str(raw)) <= LONGEST_EXPRESSION:
        # A parameter of the model may have the symbol of the field: tau of a gear with the ratio -tau.
        head = "" if spec.symbol in raw.names else f"{symbol(spec.symbol)} = "
        return f"{head}{expression(str(raw))} = {NumberText(value)}"
    name = raw.name if isinstance(raw, Name) else spec.symbol
    return f"{symbol(name)} = {quantity(value, spec.dimension)}"


def expression(text: str) -> str:
    r"""Text of an expression with the names of its parameters set as symbols in mathtext.

    >>> expression("-z_b/z_a")
    '−$z_{\\mathrm{b}}$/$z_{\\mathrm{a}}$'
    """
    shown = re.sub(r"[A-Za-z]\w*", lambda match: symbol(match[0]), text)
    return shown.replace("-", "−").replace("*", "·")


def _ratio_line(element: Element, teeth: tuple[int, int]) -> str:
    """Text of a gear's ratio as the quotient of its numbers of teeth, with the value."""
    ratio = next((spec_of(declared) for declared in element.declared() if declared.name == "ratio"), None)
    name = ratio.symbol if isinstance(ratio, QuantityKind) else "tau"
    sign = "−" if teeth[0] * teeth[1] < 0 else ""
    return f"{symbol(name)} = {sign}{abs(teeth[1])}/{abs(teeth[0])} = {NumberText(teeth[1] / teeth[0])}"


def _shaft_lines(element: Any, values: Mapping[str, Any]) -> list[str]:
    outer, inner, length = (
        float(raw.evaluate(values)) for raw in (element.outer_diameter, element.inner_diameter, element.length)
    )
    bore = f" × {quantity(inner, 'length')}" if inner else ""
    return [f"Ø {quantity(outer, 'length')}{bore}", f"{symbol('L')} = {quantity(length, 'length')}"]


# Units and labels of axes of plots, with large torques in kN m or MN m, stresses in N/mm2 and speeds in rpm.


def axis_unit(unit: str, largest: float, conventions: Conventions = SI) -> tuple[float, str]:
    """Factor from an SI unit to the unit of an axis, and text of that unit, for values up to ``largest``.

    Examples
    --------
    >>> axis_unit("N*m", 45e3), axis_unit("N*m", 900.0), axis_unit("rad", 0.1, Conventions(angle="deg"))[1]
    ((0.001, 'kN·m'), (1.0, 'N·m'), 'deg')
    """
    if unit == "N*m":
        prefix, size = prefix_of(unit, largest)
        return 1 / size, typeset_unit(prefix + unit)
    return conventions.scale(unit), typeset_unit(conventions.unit(unit))


def axis_label(name: str, unit: str, width: int = 60) -> str:
    """Text of the label of an axis, the name of its quantity and the unit in brackets, folded to ``width`` characters.

    Examples
    --------
    >>> axis_label("vibratory torque, half range", "kN·m", 20)
    'vibratory torque,\\nhalf range [kN·m]'
    """
    return textwrap.fill(f"{name} [{unit}]", width, break_long_words=False)


def speed_label(node: str) -> str:
    """Text of the label of an axis that shows the speeds of a node in rpm.

    Examples
    --------
    >>> speed_label("flywheel")
    'speed of flywheel [rpm]'
    """
    return axis_label(f"speed of {node}", "rpm")
