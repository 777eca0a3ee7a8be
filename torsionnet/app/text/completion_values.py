"""Options for the value of an entry: words, names, parameters, units, sizes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from torsionnet.app.text.completion_places import (
    CompletionOption,
    EntryPlace,
    KindWord,
    Writing,
    class_at,
    entry_place,
    holds_entries,
    summary,
    unit_text,
)
from torsionnet.app.text.name_homes import changeable_sections, properties_of
from torsionnet.base.entries.composite import Listed, Nested, PairOf, Typed
from torsionnet.base.entries.declared import Declared, files_beside
from torsionnet.base.entries.scalars import AnyQuantity, QuantityKind
from torsionnet.base.entries.spec import MODEL_NAME, EntryError, Spec, Text
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.nearby_files import nearby_file
from torsionnet.base.units import (
    CELSIUS,
    DIMENSIONS,
    KNOWN_UNITS,
    Dimension,
    UnitError,
    expected_unit,
    parse_quantity,
    parse_unit,
)
from torsionnet.model.channels import ELEMENT_QUANTITIES, ChannelEntry, ChannelName, PairEntry, Sensor
from torsionnet.model.configurations import ChangedEntry
from torsionnet.model.damping import MEASURES, DampingQuantity, LossFactor
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import CATALOGUE, CatalogueEntry, NodeName, NodePair, SizeName
from torsionnet.model.element_base.laws import GROUND
from torsionnet.model.element_base.quantity_table import TableByName, TableByNode
from torsionnet.model.files.library import library_models
from torsionnet.model.parts.part import OneOrEach
from torsionnet.report.plan.report_plan import SectionName

# Options for a key: the entries that may stand at a place, or the names that a table is by.

_NEW = "name of a new entry"
"""Key that stands for any name in a table by name."""
USUAL_TYPES = (
    "inertia",
    "spring",
    "damper",
    "shaft",
    "gear",
    "flexible_coupling",
    "propeller",
    "planetary",
    "hysteretic_spring",
)
"""Element types that most models are made of, which are offered before the others."""
_USUAL_ENTRIES = {"spring": ("stiffness",), "flexible_coupling": ("stiffness",), "gear": ("ratio",)}
"""Entries that nearly every element of a type has though another one can take their place, by type."""
NEW_MODEL = "torsionnet: 1\nname: \nparameters:\n  \nelements:\n  \ninputs:\n  \nsensors:\n  \n"
"""Text that a model begins with where nothing stands yet."""
_COLON = re.compile(r"\w*\s*:(\s|$)")


def key_options(writing: Writing) -> Iterator[CompletionOption]:
    """Options for the key that is being written, those that have to be given first."""
    spec, data = writing.place.spec, writing.place.data
    given: Mapping[Any, Any] = data if isinstance(data, Mapping) else {}
    if spec is None:
        return
    cls = class_at(writing.place)
    if isinstance(spec, Typed) and spec.key not in given:
        yield _key(writing, spec.key, spec, "required")
        if not given:
            yield from typed_options(writing, spec)
    if cls is not None:
        yield from _entries(writing, cls, given)
    yield from _name_options(writing, spec, given)
    if cls is None and not holds_entries(spec):  # of a table by name the keys are free
        yield from _keys_of_whole(writing, spec, given)


def _entries(writing: Writing, cls: type[Declared], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    specs, required = dict(cls.specs()), cls.required()
    if not given and not writing.text.strip(f"{writing.word}\n\r "):
        yield CompletionOption("torsionnet 1, a new model", "word", NEW_MODEL, "sections to be filled", "Tab goes on")
    for name in cls.head:
        if name not in given:
            yield CompletionOption(name, "entry", _with_colon(writing, name), "required", "version of the file format")
    order = sorted(specs, key=lambda name: name not in required)
    for name in order:
        if name not in given:
            yield _key(writing, name, specs[name], "required" if name in required else "")


def _key(writing: Writing, name: str, spec: Spec[Any], note: str = "") -> CompletionOption:
    unit = unit_text(spec)
    detail = ", ".join(words for words in (unit, note) if words)
    return CompletionOption(name, "entry", _with_colon(writing, name, spec), detail, spec.description)


def _with_colon(writing: Writing, name: str, spec: Spec[Any] | None = None) -> str:
    if _COLON.match(writing.after):
        return name
    if not writing.is_flow and holds_entries(spec):
        return f"{name}:\n{' ' * (writing.context.indent + 2)}"
    return f"{name}: [, ]" if isinstance(spec, NodePair) else f"{name}: "


def _name_options(writing: Writing, spec: Spec[Any], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Names of nodes or other things that are keys of a table."""
    named = NodeName("a node") if isinstance(spec, TableByNode) else spec.key_names({**given, _NEW: None}).get(_NEW)
    if isinstance(named, ChangedEntry):
        yield from _changed(writing, given)
    elif named is not None:
        for kind, name in writing.names.for_spec(named):
            if name not in given and name != GROUND:
                yield CompletionOption(name, kind, _with_colon(writing, name), kind)


def _changed(writing: Writing, given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Options for what an alternative of a configuration changes: parameters, and entries as ``box.engaged``."""
    for name in writing.names.names("parameters"):
        if name not in given:
            yield CompletionOption(name, "parameter", _with_colon(writing, name), "parameter")
    owner = writing.word.rpartition(".")[0]
    for section, table in changeable_sections().items():
        kind = section[:-1]
        if not owner:
            yield from (
                CompletionOption(f"{table_name}.", kind, f"{table_name}.", kind)
                for table_name in writing.names.table(section)
            )
            continue
        cls = class_at(EntryPlace(table.of, writing.names.table(section).get(owner)))
        for name, spec in cls.specs() if cls else ():
            full = f"{owner}.{name}"
            if full not in given:
                yield CompletionOption(full, "entry", _with_colon(writing, full), unit_text(spec), spec.description)


def _keys_of_whole(writing: Writing, spec: Spec[Any], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Keys of an entry that is read as a whole, as a damping measure; of those that exclude each other only one."""
    one_of: tuple[str, ...] = ()
    if isinstance(spec, ChannelEntry):
        one_of = spec.quantities
    elif isinstance(spec, DampingQuantity | LossFactor):
        one_of = tuple(MEASURES)
    is_chosen = any(name in given for name in one_of)
    for name, schema in properties_of(spec).items():
        if name not in given and not (is_chosen and name in one_of):
            text = schema.get("description", "") if isinstance(schema, Mapping) else ""
            yield CompletionOption(str(name), "entry", _with_colon(writing, str(name)), "", str(text))


def typed_options(writing: Writing, spec: Typed[Any], *, opens: bool = False) -> Iterator[CompletionOption]:
    """Options for a whole entry of each type with the entries that it needs, in the layout of its neighbours.

    ``opens`` says that the entry stands behind its key, so that it begins with a bracket or on a line of its own.
    """
    for kind, cls in usual_first(spec):
        needed = (*cls.required(), *(_USUAL_ENTRIES.get(kind, ()) if kind_of(spec) == "element type" else ()))
        specs = dict(cls.specs())
        is_one = sum(isinstance(specs.get(name), NodeName) for name in needed) == 1
        lines = [
            f"{spec.key}: {kind}",
            *(f"{name}: {_next_nodes(writing, specs.get(name), is_one)}" for name in needed),
        ]
        label = f"{kind} with {', '.join(needed)}" if needed else kind
        if writing.is_flow or (opens and _neighbours_are_flow(writing)):
            insert = ", ".join(lines)
            insert = f"{{{insert}}}" if opens else insert
        else:
            indent = writing.context.indent + (2 if opens else 0)
            insert = f"\n{' ' * indent}".join(["", *lines] if opens else lines)
        yield CompletionOption(label, kind_of(spec), insert, spec.what, summary(cls))


def _next_nodes(writing: Writing, spec: Spec[Any] | None, is_one: bool) -> str:
    """Nodes of the next element along the line: its last node, or that and the following one by letter or number.

    >>> from torsionnet.app.text.completion import completions
    >>> text = "elements:\\n  motor: {type: inertia, node: a, inertia: 1}\\n  shaft: spr"
    >>> completions(text, len(text))[0].insert
    '{type: spring, nodes: [a, b], stiffness: }'
    """
    last = writing.names.nodes[-1] if writing.names.nodes else ""
    if isinstance(spec, NodePair):
        pieces = re.fullmatch(r"(.*?)((?<![A-Za-z])[A-Ya-y]|)(\d*)", last)
        stem, letter, digits = pieces.groups() if pieces else (last, "", "")
        following = f"{stem}{letter}{int(digits) + 1}" if digits else f"{stem}{chr(ord(letter) + 1)}" if letter else ""
        return f"[{last}, {following}]"
    return last if isinstance(spec, NodeName) and is_one else ""


def usual_first(spec: Typed[Any]) -> list[tuple[str, type[Declared]]]:
    """Types with their names, those that most models are made of first."""
    ranks = {name: rank for rank, name in enumerate(USUAL_TYPES)}
    return sorted(spec.kinds().items(), key=lambda named: ranks.get(named[0], len(ranks)))


def kind_of(spec: Typed[Any]) -> str:
    """Kind of the options for a type: an element type, or a word."""
    return "element type" if spec.what == "element" else "word"


def _neighbours_are_flow(writing: Writing) -> bool:
    """Whether the entries beside one are written in brackets on one line, as most models write elements."""
    indent = " " * writing.context.indent
    own = writing.text.rfind("\n", 0, writing.offset) + 1
    beside = re.compile(rf"^{indent}[^\s#].*?:[ \t]*(\S?)", re.MULTILINE)
    first_signs = [beside_entry[1] for beside_entry in beside.finditer(writing.text) if beside_entry.start() != own]
    return "" not in first_signs or "{" in first_signs


# Units of a physical quantity that may follow its number.

_MULTIPLES = {
    "N": ("kN", "MN"), "Pa": ("MPa", "GPa", "bar"), "W": ("kW", "MW"), "m": ("mm",), "s": ("ms",),
    "kg*m^2": ("kg*mm^2", "t*m^2", "lbf*in*s^2", "lb*ft^2"), "N*m": ("lbf*in", "lbf*ft"),
}  # fmt: skip
"""Units that engineers write in place of the beginning of a product of SI units."""
_SHARES = ("%", "ppm", "J", "kJ", "MJ")


@lru_cache(maxsize=64)
def units_of(dimension: str) -> tuple[str, ...]:
    """Units of a named dimension, that of SI first, then its multiples and other units of the same dimension.

    Examples
    --------
    >>> units_of("inertia")[:2], "N*m" in units_of("inertia")
    (('kg*m^2', 'kg*mm^2'), False)
    >>> units_of("speed")[:2]
    ('rad/s', 'rpm')
    """
    if dimension == "1":
        return ("%",)
    first = expected_unit(dimension)
    units = [first, *([CELSIUS] if dimension == "temperature" else [])]
    # A moment without rad could be a torque that was meant to be a stiffness.
    atoms = [] if "/rad" in first else [atom for atom in KNOWN_UNITS if atom not in _SHARES and _fits(atom, dimension)]
    variants = [unit for unit in _variants(first) if _fits(unit, dimension)]
    units += [*atoms, *variants] if dimension in ("speed", "frequency") else [*variants, *atoms]
    units += [unit for name in KNOWN_UNITS for unit in _joined(name, first) if _fits(unit, dimension)]
    return tuple(dict.fromkeys(units))


def _variants(text: str) -> Iterator[str]:
    for unit, others in _MULTIPLES.items():
        if text == unit or text.startswith((f"{unit}*", f"{unit}/", f"{unit}^")):
            yield from (other + text[len(unit) :] for other in others)
    if text.startswith("N") and text.endswith("/rad"):
        yield from (f"{start}{text[:-3]}deg" for start in ("", "k"))
    if text == "rad/s":
        yield "rev/s"


def _joined(name: str, text: str) -> Iterator[str]:
    """Unit with the product at its beginning written without signs, as ``kNm/rad``."""
    product, slash, rest = text.partition("/")
    if slash and product.startswith("N*m") and name.endswith("Nm" if product == "N*m" else "Nms"):
        yield f"{name}/{rest}"


def _fits(unit: str, dimension: str) -> bool:
    try:
        return parse_unit(unit).dimension == DIMENSIONS[dimension]
    except UnitError:
        return False


@lru_cache(maxsize=1)
def usual_units() -> tuple[str, ...]:
    """Units of all dimensions of a drivetrain, those that are usual for each, for values of any dimension."""
    rarest_last = sorted((name for name in DIMENSIONS if name != "1"), key=lambda name: name == "cubic stiffness")
    return tuple(dict.fromkeys(unit for name in rarest_last for unit in units_of(name)[:3]))


_NUMBER = re.compile(r"(?:\S+?\s*\.\.\s*)?[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s+(?![\d*/+()-])")
_NAME = re.compile(r"[A-Za-z_][\w.]*$|$")
_CALL = re.compile(rf"({'|'.join(ELEMENT_QUANTITIES)})\(\s*")


def value_options(writing: Writing, spec: Spec[Any] | None) -> Iterator[CompletionOption]:
    """Options for the value that is being written."""
    word = writing.word
    # A value alone stands for an entry of a mapping: "rate" of {rate: ...}.
    if isinstance(spec, Nested) and spec.shorthand:
        spec = dict(spec.of().specs())[spec.shorthand]
    if isinstance(spec, OneOrEach):
        spec = spec.of
    if spec is None:
        return
    if isinstance(spec, KindWord) and spec.typed is not None:
        yield from _kinds(writing, spec.typed)
    elif isinstance(spec, Typed):
        if not word or word.isidentifier():
            yield from typed_options(writing, spec, opens=True)
    elif isinstance(spec, SizeName):
        yield from ((CompletionOption(size, "size", size)) for size in _sizes(writing))
    elif isinstance(spec, CatalogueEntry):
        yield from (CompletionOption(name, "word", name, "catalogue") for name in _catalogues(writing.folder))
    elif isinstance(spec, PairEntry):
        yield from _pair(writing)
    elif isinstance(spec, ChannelEntry) and not writing.word.startswith("{"):
        yield from _channels(writing, spec)
    elif isinstance(spec, NodePair | Listed | PairOf) or type(spec).__name__ == "ListOf":
        yield from _list(writing, spec)
    else:
        yield from _listed_words(spec, writing.folder)
        yield from _rows_by_name(writing, spec)
        yield from _names(writing, spec)
        if isinstance(spec, DampingQuantity) and "zeta".startswith(writing.word):
            text = "damping ratio at a frequency"
            yield CompletionOption(
                "zeta with at", "word", "{zeta: , at:  Hz}", text, f"{text}, from which c is calculated"
            )
        yield from _quantities(writing, spec)


def _kinds(writing: Writing, typed: Typed[Any]) -> Iterator[CompletionOption]:
    kind = kind_of(typed)
    for name, cls in usual_first(typed):
        yield CompletionOption(name, kind, name, typed.what, summary(cls))
    entries = writing.entries_around()
    if not entries.keys() - {typed.key} and not writing.after.strip(" }"):
        for option in typed_options(writing, typed):
            yield option._replace(insert=option.insert.removeprefix(f"{typed.key}: "))


def _channels(writing: Writing, spec: ChannelEntry[Any]) -> Iterator[CompletionOption]:
    """Options for what an input drives or a sensor shows, of each node or of each element between nodes."""
    joined = [
        name for name, raw in writing.names.table("elements").items() if isinstance(raw, Mapping) and "nodes" in raw
    ]
    for quantity in sorted(spec.quantities, key=lambda kind: kind != "torque"):
        of_element = quantity in ELEMENT_QUANTITIES and spec.made is Sensor
        for name in joined if of_element else writing.names.nodes:
            yield CompletionOption(f"{quantity} of {name}", "sensor", f"{{{quantity}: {name}}}", quantity)


def _listed_words(spec: Spec[Any], folder: Path | None) -> Iterator[CompletionOption]:
    """Words of a fixed list, from the specification of the entry or its JSON Schema."""
    if isinstance(spec, SectionName):
        from torsionnet.report.plan.report_plan import SECTIONS

        yield from (CompletionOption(name, "word", name, "section") for name in SECTIONS)
        return
    if isinstance(spec, Text) and spec.what in ("the name of a file", MODEL_NAME):
        library = library_models() if spec.what == MODEL_NAME else ()
        names = [*_files(folder, "*.yaml"), *library]
        yield from (CompletionOption(name, "word", name, spec.what) for name in names)
    schema: Any = spec.schema()
    for allowed in (schema, *schema.get("anyOf", ())):
        if allowed.get("type") == "boolean":
            yield from (CompletionOption(name, "word", name) for name in ("true", "false"))
        for value in (*allowed.get("enum", ()), *([allowed["const"]] if "const" in allowed else [])):
            yield CompletionOption(str(value), "word", str(value), "", spec.description)


def _rows_by_name(writing: Writing, spec: Spec[Any]) -> Iterator[CompletionOption]:
    """Names of the rows of the element's tables by name, as those of the gears for the one that is engaged."""
    if not isinstance(spec, Text) or spec.what != "the name of a gear":
        return
    # An alternative names the entry with its element: "gearbox.engaged".
    owner = str(writing.place.path[-1]).rpartition(".")[0]
    element: Any = writing.names.table("elements").get(owner) if owner else writing.entries_around()
    kind = element.get("type") if isinstance(element, Mapping) else None
    if not isinstance(kind, str) or kind not in ELEMENT_TYPES:
        return
    from torsionnet.model.elements.gearboxes import NEUTRAL

    specs = dict(ELEMENT_TYPES[kind].specs())
    tables = [table for key, table in element.items() if isinstance(specs.get(key), TableByName)]
    rows = [str(name) for table in tables if isinstance(table, Mapping) for name in table]
    yield from (CompletionOption(name, "word", name, "gear") for name in [*rows, NEUTRAL])


def _names(writing: Writing, spec: Spec[Any]) -> Iterator[CompletionOption]:
    """Names of things of the model that the entry may refer to."""
    call = _CALL.match(writing.word)
    if isinstance(spec, ChannelName) and call:
        for name in writing.names.names("elements"):
            yield CompletionOption(name, "sensor", f"{name})", f"{call[1]} of an element", "", call.end())
        return
    after = _after_in_pair(writing)
    for kind, name in writing.names.for_spec(spec):
        yield CompletionOption(name, kind, f"{name}{after}", kind)


def _after_in_pair(writing: Writing) -> str:
    """Comma or bracket that is still missing after one of two values ``[a, b]``."""
    if not (writing.context.is_list_item and writing.is_flow):
        return ""
    around = entry_place(writing.names.data, writing.place.path[:-1]).spec
    following = writing.after.lstrip()[:1]
    if not isinstance(around, NodePair | PairOf) or following == "]":
        return ""
    if writing.place.path[-1] == 0:
        return "" if following == "," else ", "
    return "]"


def _list(writing: Writing, spec: Spec[Any]) -> Iterator[CompletionOption]:
    """Options for the first of several values, with the bracket that begins their list."""
    if writing.word:
        if not isinstance(spec, NodePair):
            yield from _listed_words(spec, writing.folder)
        return
    is_pair = isinstance(spec, NodePair | PairOf)
    inner = spec if isinstance(spec, NodePair) else getattr(spec, "of", None)
    for kind, name in writing.names.for_spec(inner):
        yield CompletionOption(name, kind, f"[{name}, " if is_pair else f"[{name}]", kind)
    if not is_pair and isinstance(inner, Spec):
        yield from (option._replace(insert=f"[{option.insert}]") for option in _listed_words(inner, writing.folder))


def _pair(writing: Writing) -> Iterator[CompletionOption]:
    """Output and input of a transfer function, ``theta_1/T_T``."""
    output, slash, _ = writing.word.rpartition("/")
    begin = len(output) + 1 if slash else 0
    for section, kind in (("inputs", "sensor"), ("sensors", "sensor")) if slash else (("sensors", "sensor"),):
        for name in writing.names.names(section):
            yield CompletionOption(name, kind, name, section[:-1], "", begin)
    for node in writing.names.nodes:
        yield CompletionOption(node, "node", node, "node", "", begin)


def _quantities(writing: Writing, spec: Spec[Any]) -> Iterator[CompletionOption]:
    """Units after a number, and parameters in expressions."""
    named = _dimension_name(spec)
    number = _NUMBER.match(writing.word)
    takes_parameters = isinstance(spec, QuantityKind | AnyQuantity)
    if number and (named in DIMENSIONS or isinstance(spec, AnyQuantity)):
        units = units_of(named) if named in DIMENSIONS else _units_in_use(writing)
        yield from (CompletionOption(unit, "unit", unit, named, "", number.end()) for unit in units)
    elif takes_parameters and not number:
        name = _NAME.search(writing.word)
        begin = name.start() if name else len(writing.word)
        # A parameter that is the whole expression has to have the dimension of the entry; within one it may have any.
        wanted = DIMENSIONS[named] if named in DIMENSIONS and begin == 0 else None
        path, scope = writing.place.path, writing.names.scope
        is_defined_here = path[len(scope) : len(scope) + 1] == ("parameters",) or path[:1] == ("configurations",)
        own = path[len(scope) + 1 :] if is_defined_here else ()
        for parameter in writing.names.names("parameters"):
            written = _written(writing.names.table("parameters").get(parameter))
            dimension = _dimension(written)
            if parameter not in own and (wanted is None or dimension in (None, wanted)):
                yield CompletionOption(parameter, "parameter", parameter, str(written or ""), "", begin)


def _dimension_name(spec: Spec[Any]) -> str:
    """Name of the dimension of an entry, also of one that holds a band."""
    from torsionnet.base.entries.scalars import Band, Bands

    if isinstance(spec, Band | Bands):
        return "frequency"
    return "speed" if type(spec).__name__ == "SpeedBand" else getattr(spec, "dimension", "")


def _written(raw: Any) -> Any:
    return raw.get("value") if isinstance(raw, Mapping) else raw


def _dimension(raw: Any) -> Dimension | None:
    """Dimension of a value as it is written, None where it has no unit or is an expression."""
    try:
        return parse_quantity(raw).dimension if isinstance(raw, str) else None
    except UnitError:
        return None


_USUAL_LETTERS = {"k": "stiffness", "c": "damping", "J": "inertia", "I": "inertia", "T": "torque", "f": "frequency"}
"""Dimension that the letter of a parameter stands for in most models, by letter."""


def _units_in_use(writing: Writing) -> tuple[str, ...]:
    """Units for a value of any dimension: those that fit where the parameter is used or defined come first."""
    path, names = writing.place.path, writing.names
    first: list[str] = []
    parameter = str(path[path.index("parameters") + 1]) if "parameters" in path[:-1] else str(path[-1])
    for raw in names.table("elements").values():
        kind = raw.get("type") if isinstance(raw, Mapping) else None
        if isinstance(kind, str) and parameter in raw.values() and kind in ELEMENT_TYPES:
            specs = dict(ELEMENT_TYPES[kind].specs())
            used = (getattr(specs.get(key), "dimension", None) for key, value in raw.items() if value == parameter)
            # Where an element uses the parameter, its entry tells the dimension.
            first += [unit for of_use in used if of_use in DIMENSIONS for unit in units_of(str(of_use))]
    written = _written(_part_or_own(writing, parameter))
    # Else the value written so far does, with the unit that it has.
    own = _dimension(written)
    if own is not None:
        first.append(re.sub(r"^[-+.\d]+(?:[eE][-+]?\d+)?\s*", "", written.strip()))
    first += [
        unit for name, of_use in DIMENSIONS.items() if own is not None and of_use == own for unit in units_of(name)
    ]
    # Else the first letters of the name: k_1 is mostly a stiffness.
    by_name = _USUAL_LETTERS.get(parameter.partition("_")[0])
    return tuple(dict.fromkeys([*first, *(units_of(by_name) if by_name and not first else ()), *usual_units()]))


def _part_or_own(writing: Writing, parameter: str) -> Any:
    """Value as written of a parameter of the part that is used, or of the model."""
    around = [data for data in writing.place.around if isinstance(data, Mapping) and "part" in data]
    if around and "use" in writing.place.path:
        table: Any = writing.names.parts.get(str(around[-1]["part"]), {}).get("parameters")
        return table.get(parameter) if isinstance(table, Mapping) else None
    return writing.names.table("parameters").get(parameter)


def _sizes(writing: Writing) -> Iterable[str]:
    """Sizes of the catalogue that the element names."""
    from torsionnet.model.catalogues.catalogue_reading import read_catalogue, shipped_catalogues

    name = writing.entries_around().get(CATALOGUE)
    if not isinstance(name, str):
        return ()
    try:
        with files_beside(writing.folder):
            return read_catalogue(shipped_catalogues().get(name) or nearby_file(name)).sizes
    except (TorsionnetError, EntryError, OSError):
        return ()


def _catalogues(folder: Path | None) -> Iterable[str]:
    """Names of the library's catalogues, and of the tables beside the model."""
    from torsionnet.model.catalogues.catalogue_reading import shipped_catalogues

    return [*_files(folder, "*.csv"), *shipped_catalogues()]


def _files(folder: Path | None, pattern: str) -> list[str]:
    """Names of the files in a folder that fit a pattern."""
    try:
        return sorted(path.name for path in folder.glob(pattern)) if folder else []
    except OSError:
        return []
