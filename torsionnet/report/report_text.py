"""Names, units, digits and sentences as a reader of a report sees them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.base.conventions import Conventions
from torsionnet.base.equal_remarks import condition_words
from torsionnet.base.errors import comma_list
from torsionnet.base.number_text import MISSING_TYPESET, UNBROKEN_PERCENT, NumberText, prefix_of, typeset_unit
from torsionnet.base.phrases import PLACEHOLDER, Phrase, joined, phrase, with_values
from torsionnet.base.units import RPM, expected_unit
from torsionnet.model.channels import Pair, parse_sensor
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.model.definition import all_nodes
from torsionnet.report.document_tree import Inline, Math, Text
from torsionnet.symbolic.symbol_names import GREEK, symbol_latex

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


# Names, units and sentences as a reader of a report sees them.


def as_words(name: str) -> str:
    """Name of a node or element from the model as words: ``input_shaft`` is the input shaft."""
    return with_values(name, lambda value: value.replace("_", " "))


def operating_speed_sentence(rig: Drivetrain) -> tuple[str, ...]:
    """Sentence on the speed of which values that follow the operating point are shown; none where nothing follows."""
    external = rig.external_torques
    if not external.definition.following:
        return ()
    return (
        phrase(
            "Stiffness and damping that follow the speed are those at {speed:.6g} rpm of {node}.",
            speed=external.operating_speed * RPM,
            node=as_words(external.reference),
        ),
    )


def names_in_reports(rig: Drivetrain) -> frozenset[str]:
    """Names of a model as its file and as a report writes them, which are no words of the report."""
    model = rig.definition
    axes = model.configurations
    named = (model.parameters, model.elements, model.inputs, model.sensors, model.excitations, model.limits)
    names = {*all_nodes(model.elements.values()), *model.scenarios, *(name for section in named for name in section)}
    names |= {*rig.configurations, *axes, *(label for labels in axes.values() for label in labels)}
    titles = ConditionTitles(axes)
    names |= {titles.alternative(axis, label) for axis, labels in axes.items() for label in labels}
    return frozenset(
        names
        | {as_words(name) for name in names}
        | {words(name) for name in rig.configurations for words in (condition_words, titles.of)}
    )


def is_symbol(name: str) -> bool:
    """Whether a name from the model is one letter or a Greek letter, perhaps with an index.

    >>> is_symbol("theta_1"), is_symbol("T_T"), is_symbol("k1"), is_symbol("rotor_speed")
    (True, True, True, False)
    """
    match = re.fullmatch(r"([A-Za-z]+?)(\d*)(_\w+)?", name)
    return match is not None and (len(match[1]) == 1 or match[1] in GREEK)


def channel_latex(name: str) -> str:
    """LaTeX of the name of a sensor, input or node."""
    sensor = None if is_symbol(name) else parse_sensor(name)
    if sensor is not None:
        second = sensor.at or sensor.against
        at = f", {as_words(second)}" if second else ""
        return rf"\text{{{sensor.quantity}({as_words(sensor.of)}{at})}}"
    return symbol_latex(name) if is_symbol(name) else rf"\text{{{as_words(name)}}}"


def pair_latex(pair: Pair) -> str:
    """LaTeX of a transfer function as a slanted fraction."""
    return f"{channel_latex(pair.output)} / {channel_latex(pair.input)}"


def quotient_latex(pair: Pair) -> str:
    """LaTeX of a transfer function as an upright fraction, in front of its formula."""
    return rf"\frac{{{channel_latex(pair.output)}}}{{{channel_latex(pair.input)}}}"


def symbol_or_words(name: str) -> Inline:
    """Name of a sensor, input or parameter as a symbol where it looks like one, else as words."""
    return Math(symbol_latex(name)) if is_symbol(name) else as_words(name)


def criterion_cell(criterion: str) -> Inline:
    """Name of a criterion of a limit as a symbol where it looks like one, else in words that have other languages."""
    return Math(symbol_latex(criterion)) if is_symbol(criterion) else criterion_words(criterion)


def criterion_words(criterion: str) -> str:
    """Name of a criterion of a limit in words that a report may say otherwise."""
    return phrase(as_words(criterion))


def sentence(text: str, rig: Drivetrain, further: Sequence[str] = ()) -> Text:
    """Sentence in which names of nodes and elements are words and names of quantities symbols.

    >>> import torsionnet as tn
    >>> sentence("cut at T_T, without half_shaft", tn.load("amt_rig"))
    ('cut at ', Math(latex='T_{T}'), ', without half shaft')
    """
    text = _unbroken_percent(text)
    symbols = {
        name
        for table in (rig.inputs, rig.sensors, rig.parameters, further)
        for name in table
        if _is_quantity_name(name)
    }
    words = {name for name in (*rig.nodes, *rig.definition.elements) if "_" in name} - symbols
    names = sorted({*symbols, *words}, key=len, reverse=True)
    if not names:
        return (text,)
    parts: list[Inline] = []
    for piece in re.split(rf"(?<!\w)({'|'.join(map(re.escape, names))})(?!\w)", text):
        if piece in symbols:
            parts.append(Math(symbol_latex(piece)))
        elif parts and isinstance(parts[-1], str):
            parts[-1] += as_words(piece) if piece in words else piece
        elif piece:
            parts.append(as_words(piece) if piece in words else piece)
    if not isinstance(text, Phrase):
        return tuple(parts)
    if len(parts) == 1:
        return (with_values(text, lambda value: "".join(map(str, sentence(value, rig, further)))),)
    # Symbols part a phrase: what stands between its places may be said otherwise, piece by piece.
    pieces = PLACEHOLDER.split(text.template)
    inserted = (piece for place in pieces[1::2] for piece in (sentence(str(text.values[place]), rig, further),))
    said = zip(((piece,) if piece else () for piece in pieces[::2]), (*inserted, ()), strict=True)
    return tuple(inline for words, value in said for inline in (*words, *value))


def _unbroken_percent(text: str) -> str:
    """Text, of a phrase its template too, in which no line ends before a percent sign."""
    if isinstance(text, Phrase):
        values = {place: _unbroken_percent(str(value)) for place, value in text.values.items()}
        return Phrase(text.template.replace(" %", UNBROKEN_PERCENT), values)
    return text.replace(" %", UNBROKEN_PERCENT)


def _is_quantity_name(name: str) -> bool:
    """Whether a name in a sentence is surely that of a quantity, and no word or article."""
    return is_symbol(name) and "_" in name


def unit(text: str) -> str:
    """SI unit as documents print it: ``rad/(N·m)``, a dash for none."""
    return MISSING_TYPESET if text in ("", "1") else typeset_unit(text)


def capital(text: str) -> str:
    """Text with a capital first letter; names from the model stay as they are.

    >>> capital("measured input"), capital("theta_1 moves")
    ('Measured input', 'theta_1 moves')
    """
    if "_" in text.partition(" ")[0]:
        return text
    if not isinstance(text, Phrase):
        return text[:1].upper() + text[1:]
    if place := PLACEHOLDER.match(text.template):
        return Phrase(text.template, {**text.values, place[1]: capital(str(text.values[place[1]]))})
    return Phrase(text.template[:1].upper() + text.template[1:], text.values)


def in_clauses(text: str) -> str:
    """Text of clauses between semicolons, each of which may be said in other words.

    >>> in_clauses("bending; short circuits").values
    {'text0': 'bending', 'text1': 'short circuits'}
    """
    return joined("; ", map(phrase, text.split("; ")))


def first_names(names: Sequence[str], most: int = 12) -> str:
    """Text with the names, separated by commas; of many the first ``most`` and how many more there are."""
    return comma_list(names, most, ", … and {} more")


def shared_choices(names: Sequence[str]) -> str:
    """Text of the choices that all these configurations share in their names; all names where they share none.

    Examples
    --------
    >>> shared_choices(["water=wet,firing=normal", "water=wet,firing=misfire"]), shared_choices(["normal", "misfire"])
    ('water=wet', 'normal, misfire')
    """
    parts = [name.split(",") for name in names]
    shared = [part for part in parts[0] if all(part in other for other in parts)] if parts else []
    return ",".join(shared) or first_names(names, 3)


def distinct_choices(name: str, names: Sequence[str]) -> str:
    """Text of the choices in the name of a configuration that not all of ``names`` have.

    Examples
    --------
    >>> distinct_choices("water=wet,firing=misfire", ["water=wet,firing=normal", "water=wet,firing=misfire"])
    'firing=misfire'
    """
    shared = shared_choices(names).split(",")
    return ",".join(part for part in name.split(",") if part not in shared) or name


def choices_of_some(some: Sequence[str], names: Sequence[str]) -> str:
    """Text that names some of several configurations: by the choices that only these share, else one by one.

    Examples
    --------
    >>> every = ["water=wet,firing=normal", "water=dry,firing=normal", "water=wet,firing=misfire"]
    >>> choices_of_some(every[::2], every), choices_of_some(every[:2], every), choices_of_some(every[1:], every)
    ('water=wet', 'firing=normal', 'water=dry,firing=normal; water=wet,firing=misfire')
    """
    shared = [part for part in some[0].split(",") if all(part in name.split(",") for name in some)] if some else []
    if shared and [name for name in names if set(shared) <= set(name.split(","))] == list(some):
        return ",".join(shared)
    return first_names(some) if not any("," in name for name in some) else "; ".join(some)


# Units and digits in which a report shows values, as engineers of machinery write them: kN m, kW, N/mm2, mrad, rpm.

DIGITS = 3
"""Significant digits of stresses, torques and shares: a torsional calculation is not known better."""
KILO = {"W": "kW", "W/m^2": "kW/m^2"}
"""Unit of a thousand, by SI unit, for what machinery has in thousands."""
UNITS = {
    "length": ("mm", 1e3),
    "power": ("kW", 1e-3),
    "heat flux": ("kW/m^2", 1e-3),
    "speed": ("rpm", RPM),
    "angle": ("deg", 180 / math.pi),
}
"""Unit of engineers and its factor over SI, by dimension."""
FACTOR_UNITS = {"m": (1e3, "mm"), "m^3": (1e6, "cm^3"), "Pa": (1e-6, "N/mm^2"), "1": (1.0, "")}
"""Factor and unit in which rules state the factors of a shaft, by SI unit."""


def engineering_unit(unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to the unit of engineers, without unit, and the name of that unit.

    Torques are in kN m, so that those of one component have one unit in all tables, unless a ``size`` in N m is given.

    Examples
    --------
    >>> engineering_unit("N*m", Conventions(), 25e3), engineering_unit("rad", Conventions())
    ((0.001, 'kN*m'), (1000.0, 'mrad'))
    >>> engineering_unit("Pa", Conventions())
    (1e-06, 'N/mm^2')
    """
    if unit in KILO:
        return 1e-3, KILO[unit]
    if unit == "rad" and conventions.angle == "rad":
        return 1e3, "mrad"
    if unit == "N*m":
        prefix, factor = prefix_of(unit, size)
        return 1 / factor, prefix + unit
    return conventions.scale(unit), conventions.unit(unit)


def limit_scale(si_unit: str, conventions: Conventions, size: float = 1e3) -> tuple[float, str]:
    """Factor from an SI unit to that in which a report shows values of a limit, and its name: angles are in degrees.

    >>> limit_scale("rad", Conventions())[1], limit_scale("N*m", Conventions())
    ('deg', (0.001, 'kN*m'))
    """
    in_degrees = replace(conventions, angle="deg") if conventions.angle == "rad" and si_unit == "rad" else conventions
    return engineering_unit(si_unit, in_degrees, size)


def limit_unit(si_unit: str, conventions: Conventions) -> str:
    """Name of the unit in which a report shows values of a limit.

    >>> limit_unit("N*m", Conventions()), limit_unit("Pa", Conventions())
    ('kN·m', 'N/mm²')
    """
    return unit(limit_scale(si_unit, conventions)[1])


def limit_number(value: float, si_unit: str, conventions: Conventions) -> NumberText:
    """Number of a value of a limit, in SI, in the unit in which a report shows it."""
    return NumberText(value * limit_scale(si_unit, conventions)[0], DIGITS)


def quantity_text(number: float, dimension: str) -> str:
    """Text of a quantity in SI in the unit that engineers use for it.

    Examples
    --------
    >>> quantity_text(0.6, "length"), quantity_text(188.7e3, "torque"), quantity_text(1.234e5, "inertia")
    ('600 mm', '188.7 kN·m', '123400 kg·m²')
    """
    if dimension == "1":
        return f"{number:.5g}".replace("-", "−")
    name, factor = UNITS.get(dimension, (expected_unit(dimension), 1.0))
    if name.startswith("N*m"):
        prefix, size = prefix_of(name, number)
        name, factor = prefix + name, 1 / size
    said = NumberText(number * factor, 5)
    return phrase("{value} rpm", value=said) if dimension == "speed" else f"{said} {unit(name)}"
