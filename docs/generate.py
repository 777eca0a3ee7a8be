"""What is made from the code: pages, tables and pictures of the documentation, stubs, and the JSON Schemas.

``python docs/made_files.py`` (``make generate``) writes what is not current; conf.py does the same before every build.
"""

from __future__ import annotations

import doctest
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import MISSING, Field
from fractions import Fraction
from functools import cache
from inspect import getdoc
from pathlib import Path
from typing import Any

import sympy
from fault_pages import faults_page
from house_picture import layers_page, picture
from motion_text import torque_text
from page_parts import code, prose, table
from reference_pages import reference_index, write_reference
from schema_pages import file_entries_page
from stubs import write_stubs
from study_pages import study_file_page
from validation_pages import bench_numbers_page, cases_page, paper_page
from verification_pages import verification_page
from words_page import words_page

import torsionnet as tn
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind, ValueInUnitOfUse
from torsionnet.base.entries.spec import Count, Flag, OneOf, Spec, spec_of
from torsionnet.base.errors import ModelError
from torsionnet.base.expressions import Algebra
from torsionnet.base.units import _BASE, _JOINED, _PREFIXES, DIMENSIONS, Dimension, expected_unit
from torsionnet.bench.plan import (
    Acquisition,
    Creep,
    DropOuts,
    Encoder,
    Exciter,
    Hum,
    PitchErrors,
    RadialVibration,
    RecordingSystem,
    ShuntCalibration,
    StrainGauge,
    ToothedWheel,
    Transducer,
    ZeroDrift,
)
from torsionnet.bench.plan.plan import EXCITATIONS, MOTIONS
from torsionnet.model.damping import MEASURES, LossFactor
from torsionnet.model.element_base.element_entries import MultipleValues, NodeName, NodePair, Teeth
from torsionnet.model.element_base.shaft_stiffness import ShaftStiffness
from torsionnet.model.elements import (
    ELEMENT_TYPES,
    GROUND,
    Action,
    Constraint,
    Element,
    Law,
    MotionLaw,
    Part,
    Row,
    Values,
    make_element,
)  # fmt: skip
from torsionnet.report.plan.report_plan import SECTIONS
from torsionnet.report.wording import replaceable_texts

SAMPLES = {
    "torque": "180 kN*m",
    "speed": "150 rpm",
    "inertia": "0.15 kg*m^2",
    "stiffness": "13.3 kN*m/rad",
    "damping": "4 N*m*s/rad",
    "length": "0.5 m",
    "shear modulus": "80 GPa",
    "density": "7850 kg/m^3",
    "mass": "0.8 kg",
    "frequency": "10 Hz",
    "temperature": "60 degC",
    "angle": "3 deg",
    "area": "0.6 m^2",
    "force": "80 kN",
    "linear stiffness": "300 kN/m",
    "velocity": "20 m/s",
    "per velocity": "0.0001 s/m",
    "power": "3 MW",
    "time": "0.05 s",
    "pressure": "206 GPa",
    "1": 3,
}
S = sympy.Symbol("s")
COMMON = ("description", "enabled", "catalogue", "size", "referred_to")


# Elements


def elements_page() -> str:
    """Text of the reference of elements, with a section for each registered type."""
    return "\n".join(element_section(kind, cls) for kind, cls in ELEMENT_TYPES.items())


def element_index() -> str:
    """Table of the registered element types with the first sentences of their descriptions."""
    lines = [f"| [{kind}](#{kind}) | {first_sentence(cls)} |" for kind, cls in sorted(ELEMENT_TYPES.items())]
    return "\n".join(["| type | what it is |", "|---|---|", *lines, ""])


def first_sentence(cls: type[Element]) -> str:
    return (getdoc(cls) or "").partition("\n")[0].rstrip(".")


def element_section(kind: str, cls: type[Element]) -> str:
    minimal = sample(cls, full=False)
    ports = list(minimal.ports)
    known = {*ports, "nodes"}
    optional = [declared.name for declared in own_fields(cls) if is_port(declared) and declared.name not in known]
    more = f"; optional: {', '.join(map(code, optional))}" if optional else ""
    rest = "" if len(ports) == 1 else " At any other port: positive when it drives out of the element."
    sign = (
        f"The sign of the torque is defined at `{ports[0]}`: {cls.sign}.{rest}" if ports else f"Torque is {cls.sign}."
    )
    parts = [
        f"## {kind}\n",
        f"*In Python:* `torsionnet.{cls.__name__}`\n",
        f"![How a schematic draws it](generated/symbol_{kind}.svg)\n",
        physics(cls),
        laws(cls),
        f"*Ports:* {', '.join(map(code, ports)) or 'none'}{more}. {sign}\n",
        fields_table(cls),
        f"```yaml\nelements:\n  {minimal.name}: {flow(minimal.to_data())}\n```\n",
    ]
    return "\n".join(parts)


def own_fields(cls: type[Element]) -> list[Field[Any]]:
    return [declared for declared in cls.declared() if declared.name not in COMMON]


def is_port(declared: Field[Any]) -> bool:
    return isinstance(spec_of(declared), (NodeName, NodePair))


def physics(cls: type[Element]) -> str:
    """Docstring of a class up to its examples."""
    return (getdoc(cls) or "").partition("\nExamples\n")[0].strip() + "\n"


def sample(cls: type[Element], *, full: bool, symbolic: bool = False) -> Element:
    """First element made in the docstring of a class, as written or with all other quantities that go with it."""
    first = made_in_docstring(cls)[0]
    data = {name: getattr(first, name) for name in first.to_data() if name != "type"}
    if symbolic:
        data = in_symbols(cls, data)
    for declared in own_fields(cls) if full else ():
        value = None if declared.name in data else sample_value(declared, symbolic=symbolic)
        if value is not None and constructible(cls, data | {declared.name: value}):
            data |= {declared.name: value}
    return make_element(cls.kind, first.name, data)


@cache
def made_in_docstring(cls: type[Element]) -> tuple[Element, ...]:
    """Elements of a type that the examples in its docstring make."""
    made: list[Element] = []

    def recorded(*args: Any, **entries: Any) -> Element:
        made.append(cls(*args, **entries))
        return made[-1]

    names = vars(sys.modules[cls.__module__]) | {cls.__name__: recorded}
    for example in doctest.DocTestParser().get_examples(getdoc(cls) or ""):
        exec(example.source, names)  # noqa: S102 - docstrings of this package, which the tests run as well
    return tuple(made)


def in_symbols(cls: type[Element], data: dict[str, Any]) -> dict[str, Any]:
    """Arguments of an element with every quantity as its symbol, unless the element needs its number."""
    for declared in own_fields(cls):
        kind = spec_of(declared)
        if isinstance(kind, NodeName) and data.get(declared.name) == GROUND:
            data = data | {declared.name: declared.name}
        if declared.name == "ratio" and isinstance(data.get("teeth"), tuple):
            data = {name: value for name, value in data.items() if name != "teeth"} | {"ratio": kind.symbol}
        elif isinstance(kind, QuantityKind) and (declared.name in data or isinstance(declared.default, str)):
            trial = data | {declared.name: kind.symbol}
            data = trial if constructible(cls, trial) and has_laws(cls, trial) else data
    return data


def constructible(cls: type[Element], data: dict[str, Any]) -> bool:
    try:
        make_element(cls.kind, "part", data)
    except ModelError:
        return False
    return True


def has_laws(cls: type[Element], data: dict[str, Any]) -> bool:
    """Whether the laws of an element can be written in symbols."""
    try:
        described(make_element(cls.kind, "part", data))
    except TypeError:
        return False
    return True


def sample_value(declared: Field[Any], *, symbolic: bool) -> Any:
    """Valid value of an entry beside the values of the example; None for entries that do not occur in laws."""
    kind = spec_of(declared)
    if isinstance(kind, NodeName):
        return declared.name
    if isinstance(kind, QuantityKind):
        loss = 0.1 if isinstance(kind, LossFactor) else SAMPLES.get(kind.dimension)
        return kind.symbol if symbolic else loss
    return True if isinstance(kind, Flag) else None


def laws(cls: type[Element]) -> str:
    """Rows and laws of an element type in symbols, of its plainest element and of one with everything given."""
    plain, full = (described(sample(cls, full=full, symbolic=True)) for full in (False, True))
    if plain == full:
        return plain
    return f"With the entries of the example below:\n\n{plain}\nWith all quantities that go with them:\n\n{full}"


def described(element: Element) -> str:
    names = {name for _, _, expression, _ in element.expressions() for name in expression.names}
    algebra = Algebra(number=lambda x: sympy.Rational(x.numerator, x.denominator), sqrt=sympy.sqrt, pi=sympy.pi)
    value = Values({name: sympy.Symbol(name, positive=True) for name in names}, algebra)
    return "\n".join(f"$${text}$$\n" for one in element.expanded() for text in law_texts(one, value))


def law_texts(element: Element, value: Values) -> list[str]:
    """LaTeX of the laws of an element, those of motion in full where they have a formula."""
    whole = element.whole_parts(value)
    torques = {number: torque_text(part) for number, part in enumerate(whole) if isinstance(part, MotionLaw)}
    if None in torques.values():
        return [part_text(part) for part in element.parts(value)]
    return [
        rf"\gamma = {angles(part.row)},\qquad {torques[number]}" if isinstance(part, MotionLaw) else part_text(part)
        for number, part in enumerate(whole)
    ]


def part_text(part: Part) -> str:
    """LaTeX of a law, a constraint or an action."""
    if isinstance(part, Action):
        return rf"T_{{{angles(part.row)}}} = {action(part)} \left({angles(part.sensed)}\right)"
    return rf"\gamma = {angles(part.row)},\qquad {law_text(part)}"


def angles(row: Row) -> str:
    """LaTeX of a row as a sum of angles."""
    text = ""
    for node, coefficient in row.items():
        factor = sympy.factor(sympy.sympify(coefficient))
        negative = factor.could_extract_minus_sign()
        size = sympy.factor(-factor) if negative else factor
        shown = "" if size == 1 else f"\\left({sympy.latex(size)}\\right)" if size.is_Add else sympy.latex(size)
        sign = "-" if negative else "+" if text else ""
        text += rf" {sign} {shown} \theta_\mathrm{{{node.replace('_', chr(92) + '_')}}}"
    return text


def action(part: Action) -> str:
    """LaTeX of the transfer function of an action."""
    above, below = (
        sympy.latex(sum(value * S**power for power, value in enumerate(map(sympy.sympify, values))))
        for values in (part.numerator, part.denominator)
    )
    delay = sympy.sympify(part.delay)
    late = "" if delay == 0 else rf"\,\mathrm{{e}}^{{-{sympy.latex(delay)} s}}"
    return (rf"\left({above}\right)" if below == "1" else rf"\frac{{{above}}}{{{below}}}") + late


def law_text(part: Law | Constraint) -> str:
    if isinstance(part, Constraint):
        return r"\gamma = 0"
    return rf"\kappa(s) = {kappa(part)}"


def kappa(law: Law) -> str:
    terms = [
        product(coefficient, power)
        for coefficient, power in ((law.inertia, "s^2"), (law.damping, "s"))
        if sympy.sympify(coefficient) != 0
    ]
    if isinstance(law.table, ShaftStiffness):
        return wave_text(law.table)
    if law.table is not None:
        return r"k(f) + \mathrm{j}\,\omega\,c(f)"
    loss = sympy.sympify(law.loss_factor)
    if sympy.sympify(law.stiffness) != 0:
        terms.append(product(law.stiffness, "" if loss == 0 else rf"(1 + \mathrm{{j}}\,{sympy.latex(loss)})"))
    return " + ".join(terms)


def wave_text(table: ShaftStiffness) -> str:
    """LaTeX of a law of a continuous shaft in K, the stiffness of the piece with its loss, and its x."""
    K, x, omega = sympy.symbols("K x omega", positive=True)
    return sympy.latex(table.with_coefficients(K, K * x**2 / omega**2, 0).formula(omega))


def with_curves_named(expression: sympy.Expr) -> sympy.Expr:
    """Formula with every piecewise linear curve replaced by a named function of its argument."""
    return expression.replace(
        lambda part: part.is_Add and part.has(sympy.Abs),
        lambda part: sympy.Function("curve")(*sorted(part.free_symbols, key=str)),
    )


def product(coefficient: Any, factor: str) -> str:
    value = with_curves_named(sympy.sympify(coefficient))
    text = sympy.latex(value)
    return (f"\\left({text}\\right)" if value.is_Add and factor else text) + (f"\\,{factor}" if factor else "")


def fields_table(cls: type[Element]) -> str:
    headings = ["entry", "symbol", "unit", "bounds", "default", "what it is"]
    return table(headings, [field_row(declared) for declared in own_fields(cls)])


def field_row(declared: Field[Any]) -> list[str]:
    kind = spec_of(declared)
    kind = kind.of if isinstance(kind, MultipleValues) else kind
    is_quantity = isinstance(kind, QuantityKind)
    symbol = f"${sympy.latex(sympy.Symbol(kind.symbol))}$" if is_quantity else ""
    unit = "" if not is_quantity else "-" if kind.dimension == "1" else code(expected_unit(kind.dimension))
    default = "required" if declared.default is MISSING else default_text(declared.default)
    return [code(declared.name), symbol, unit, bounds(kind), default, prose(spec_of(declared).description)]


def default_text(default: Any) -> str:
    if default is None:
        return "none"
    return code({True: "true", False: "false"}[default] if isinstance(default, bool) else default)


def bounds(kind: Spec) -> str:
    match kind:
        case OneOf():
            text = " or ".join(map(code, kind.options))
        case Count():
            text = f"{kind.lower} to {kind.upper}"
        case Flag():
            text = "`true` or `false`"
        case Teeth():
            text = "whole, not 0"
        case QuantityKind(lower=None):
            text = "not 0" if kind.nonzero else ""
        case QuantityKind():
            text = f"{'>' if kind.exclusive else '>='} {kind.lower:g}"
        case _:
            text = ""
    return text


def flow(data: Any) -> str:
    """Text of plain data in YAML's flow style, as one line of a model file."""
    if isinstance(data, dict):
        return "{" + ", ".join(f"{key}: {flow(value)}" for key, value in data.items()) + "}"
    if isinstance(data, (list, tuple)):
        return "[" + ", ".join(map(flow, data)) + "]"
    return {True: "true", False: "false"}[data] if isinstance(data, bool) else str(data)


# Units and damping


def units_page() -> str:
    names = {dimension: name for name, dimension in reversed(DIMENSIONS.items())}
    names |= {DIMENSIONS["angle"]: "angle, number", DIMENSIONS["shear modulus"]: "shear modulus"}
    rows = []
    for name, (factor, dimension, prefixes) in sorted(_BASE.items(), key=lambda entry: str(entry[1][1])):
        with_prefix = ", ".join(code(prefix + name) for prefix in prefixes)
        rows.append(
            [code(name), names.get(dimension, "force" if name.endswith(("N", "f")) else ""), factor_text(factor)]
        )
        rows[-1] += [code(shown_dimension(dimension)), with_prefix]
    joined = ", ".join(f"{code(name)}" for name in _JOINED)
    prefixes = ", ".join(f"{code(name)} {float(value):g}" for name, value in _PREFIXES.items() if name)
    accepted = [[name, code(unit), code(expected_unit(name))] for name, unit in WANTED.items()]
    return "\n".join(
        [
            table(["unit", "of", "in SI", "SI unit", "with prefix"], rows),
            f"Prefixes: {prefixes}, only where the table has them.\n",
            f"Written as one word: {joined}. Anything else needs a `*` between its parts.\n",
            "What an entry expects, and a unit of it that is not SI:\n",
            table(["quantity", "for example", "SI"], accepted),
        ]
    )


WANTED = {
    "inertia": "lbf*in*s^2",
    "stiffness": "kN*m/rad",
    "compliance": "rad/(N*m)",
    "damping": "lbf*in*s/rad",
    "torque": "kN*m",
    "angle": "deg",
    "speed": "rpm",
    "frequency": "cpm",
    "length": "mm",
    "mass": "lb",
    "force": "kN",
    "linear stiffness": "kN/m",
    "velocity": "km/h",
    "density": "kg/m^3",
    "shear modulus": "GPa",
}


def shown_dimension(dimension: Dimension) -> str:
    return str(dimension) or "1"


def factor_text(factor: Fraction | float) -> str:
    if isinstance(factor, Fraction) and factor.denominator == 1 and factor < 10**6:
        return str(factor)
    return f"{float(factor):.10g}"


def damping_page() -> str:
    x, ratio = sympy.Symbol("x", positive=True), sympy.Symbol("omega") / sympy.Symbol("k")
    algebra = Algebra(number=sympy.Rational, sqrt=sympy.sqrt, pi=sympy.pi)
    rows = []
    for name, measure in MEASURES.items():
        own, eta = sympy.Symbol(measure.symbol), sympy.Symbol("eta")
        forward = sympy.latex(measure.to_loss_factor(x, algebra, ratio).subs(x, own))
        back = sympy.latex(measure.from_loss_factor(eta, algebra, ratio))
        example = tn.convert_damping(0.04, "eta", name, stiffness=1000.0, frequency=10.0)
        cells = [code(name), f"${sympy.latex(own)}$", prose(measure.description)]
        rows.append([*cells, rf"$\eta = {forward}$", rf"${sympy.latex(own)} = {back}$", f"{example:.6g}"])
    headings = ["entry", "symbol", "what it is", "loss factor from it", "it from the loss factor", "at eta = 0.04"]
    note = "The last column holds for 1000 N m/rad at 10 Hz, which only `c` depends on.\n"
    return table(headings, rows) + "\n" + note


# The parts of a bench


def bench_page() -> str:
    """Text of the page on the entries of a ``bench:`` section."""
    sections: list[tuple[str, type[Declared]]] = [
        ("`exciter`", Exciter),
        ("Channel of `type: transducer`", Transducer),
        ("`hum` of a transducer or strain gauge", Hum),
        ("`drop_outs` of a transducer or strain gauge", DropOuts),
        ("Channel of `type: strain gauge`", StrainGauge),
        ("`shunt` of a strain gauge", ShuntCalibration),
        ("`zero_drift` of a strain gauge", ZeroDrift),
        ("`creep` of a strain gauge", Creep),
        ("Channel of `type: encoder`", Encoder),
        ("Channel of `type: toothed wheel`", ToothedWheel),
        ("`pitch_errors` of a toothed wheel", PitchErrors),
        ("`radial_vibration` of a toothed wheel", RadialVibration),
        ("`acquisition`", Acquisition),
        ("One of `systems`", RecordingSystem),
    ]
    sections += [(f"`motion` of `type: {kind}`", cls) for kind, cls in MOTIONS.items()]
    sections += [(f"`excitation` of `type: {kind}`", cls) for kind, cls in EXCITATIONS.items()]
    return "\n".join(_entries_table(title, cls) for title, cls in sections)


def _entries_table(title: str, cls: type[Declared]) -> str:
    rows = []
    for name, kind in cls.specs():
        unit = getattr(kind, "dimension", "")
        of_use = isinstance(kind, ValueInUnitOfUse)
        shown = "of what is measured" if of_use else code(expected_unit(unit)) if unit else ""
        rows.append([code(name), "required" if name in cls.required() else "", prose(kind.description), shown])
    return f"**{title}**\n\n" + table(["entry", "", "meaning", "unit"], rows)


# The sections of a report


def report_page() -> str:
    """Table of the sections of a report with their contents."""
    return table(
        ["section", "kind", "what it holds"],
        [[code(name), " and ".join(content.kinds), prose(content.description)] for name, content in SECTIONS.items()],
    )


def report_texts_page() -> str:
    """YAML of the texts of a report that words.yaml of a template folder may replace."""
    shown = [
        f"{section}:\n" + "".join(f"  {text}\n" for text in map(_quoted, texts))
        for section, texts in replaceable_texts().items()
    ]
    return "```text\n" + "\n".join(shown) + "```\n"


def _quoted(text: str) -> str:
    """Text quoted where a key of YAML needs it."""
    return f'"{text}"' if text != text.strip() or text[0] in ",:;{." or ": " in text or text.endswith(":") else text


# What is refused

TRAP_MODEL = """\
torsionnet: 1
parameters: {{k: 1 kN*m/rad, tau: {ratio}}}
elements:
  disc:  {{type: inertia, node: a, inertia: {inertia}}}
  shaft: {{type: spring, nodes: [a, b], stiffness: {stiffness}}}
  stage: {{type: gear, nodes: [b, c], ratio: tau}}
  load:  {{type: inertia, node: c, inertia: 2, enabled: {enabled}}}
"""
SOUND = {"inertia": "0.1 kg*m^2", "stiffness": "k", "ratio": "3", "enabled": "true"}
TRAPS = (
    ("stiffness", "13,3 kN*m/rad", "a decimal comma; some readers take 133"),
    ("ratio", "3:1", "YAML 1.1 makes 181 of it (base 60)"),
    ("ratio", "017", "YAML 1.1 makes 15 of it (octal)"),
    ("enabled", "no", "YAML 1.1 makes `false` of it, and of the country code"),
    ("inertia", "0.1 kg*m", "a unit of the wrong dimension"),
    ("inertia", "0.1 kgm^3", "a unit nobody has"),
    ("stiffness", "50 Hz", "a frequency is no stiffness"),
    ("stiffness", "2 k", "a product without its sign"),
    ("stiffness", "k + 3 N*m/rad", "a quantity inside an expression"),
    ("stiffness", "k**5", "an exponent above 4"),
    ("stiffness", "abs(k)", "a function"),
    ("inertia", ".inf", "no finite number"),
    ("inertia", "-0.1", "a negative inertia"),
    ("stiffness", "kk", "a misspelt name"),
)


def traps_page() -> str:
    rows = [[code(written), why, refusal(entry, written)] for entry, written, why in TRAPS]
    return table(["written", "the trap", "what torsionnet says"], rows)


def refusal(entry: str, written: str) -> str:
    try:
        tn.loads(TRAP_MODEL.format(**SOUND | {entry: written}), "model.yaml")
    except ModelError as error:
        return code(error.faults[0].message)
    raise AssertionError(written)


# Files


def symbol_pictures(folder: Path) -> None:
    """Write the pictures of the symbols of all elements."""
    import symbol_picture

    for kind, cls in ELEMENT_TYPES.items():
        symbol_picture.write(folder, kind, [sample(cls, full=False), sample(cls, full=True)])


def sign_pictures(folder: Path) -> None:
    """Write the pictures of the page on sign conventions."""
    import sign_picture

    sign_picture.write_all(folder)


def law_pictures(folder: Path) -> None:
    """Write the picture of the page on laws of motion."""
    import law_picture

    law_picture.write(folder)


def tutorial_pictures(folder: Path) -> None:
    """Write the pictures of the tutorials, by the commands that their pages show."""
    import tutorial_steps

    tutorial_steps.write_pictures(folder)


def schemas(folder: Path) -> None:
    """Write the JSON Schemas of model, study and campaign files, as ``torsionnet schema`` does."""
    from torsionnet.app.cli import main

    for kind, name in (("model", "torsionnet"), ("study", "study"), ("campaign", "campaign")):
        with (folder / f"{name}.schema.json").open("w", encoding="utf-8") as file, redirect_stdout(file):
            main(["schema", "--kind", kind])


PAGES = {
    "elements.md": elements_page,
    "element_index.md": element_index,
    "reference_index.md": reference_index,
    "units.md": units_page,
    "damping.md": damping_page,
    "traps.md": traps_page,
    "file_entries.md": file_entries_page,
    "study_file.md": study_file_page,
    "paper.md": paper_page,
    "cases.md": cases_page,
    "verification.md": verification_page,
    "bench.md": bench_page,
    "bench_numbers.md": bench_numbers_page,
    "report.md": report_page,
    "report_texts.md": report_texts_page,
    "layers.md": layers_page,
    "faults.md": faults_page,
    "words.md": words_page,
    "house.svg": picture,
}
WRITERS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "sign pictures": ("docs/generated", sign_pictures),
    "symbol pictures": ("docs/generated", symbol_pictures),
    "law pictures": ("docs/generated", law_pictures),
    "tutorial pictures": ("docs/generated", tutorial_pictures),
    "reference": ("docs/reference", write_reference),
    "schemas": ("library", schemas),
    "stubs": ("", write_stubs),
}
"""Folders of the checkout, and what writes several files into them."""


def write(name: str, root: Path) -> None:
    """Write what PAGES or WRITERS have by a name, below a folder that stands for the checkout."""
    place, writer = WRITERS.get(name, ("docs/generated", None))
    folder = root / place
    folder.mkdir(parents=True, exist_ok=True)
    if writer:
        writer(folder)
    else:
        (folder / name).write_text(PAGES[name](), encoding="utf-8")
