"""Options for the value of an entry: words, names, parameters, units, sizes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from torsionnet.app.text.completing.completion_keys import kind_of, typed_options, usual_first
from torsionnet.app.text.completing.completion_option import CompletionOption, Writing, summary
from torsionnet.app.text.completing.completion_places import KindWord, entry_place
from torsionnet.app.text.completing.completion_units import units_of, usual_units
from torsionnet.base.entries.composite import Listed, Nested, PairOf, Typed
from torsionnet.base.entries.declared import files_beside, nearby_file
from torsionnet.base.entries.scalars import AnyQuantity, QuantityKind
from torsionnet.base.entries.spec import MODEL_NAME, EntryError, Spec, Text
from torsionnet.base.errors import TorsionnetError
from torsionnet.base.units import DIMENSIONS, Dimension, UnitError, parse_quantity
from torsionnet.model.catalogues.catalogue_entries import CATALOGUE, CatalogueEntry, SizeName
from torsionnet.model.channels import ELEMENT_QUANTITIES, ChannelName
from torsionnet.model.element_base.element import ELEMENT_TYPES
from torsionnet.model.element_base.element_entries import NodePair
from torsionnet.model.element_base.quantity_table import TableByName
from torsionnet.model.files.library import library_models
from torsionnet.model.parts.use import OneOrEach
from torsionnet.model.response_pair import PairEntry
from torsionnet.report.plan.report_plan import SectionName

_NUMBER = re.compile(r"(?:\S+?\s*\.\.\s*)?[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s+(?![\d*/+()-])")
_NAME = re.compile(r"[A-Za-z_][\w.]*$|$")
_CALL = re.compile(rf"({'|'.join(ELEMENT_QUANTITIES)})\(\s*")


def value_options(writing: Writing, spec: Spec[Any] | None) -> Iterator[CompletionOption]:
    """Options for the value that is being written."""
    word = writing.word
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
    elif isinstance(spec, NodePair | Listed | PairOf) or type(spec).__name__ == "ListOf":
        yield from _list(writing, spec)
    else:
        yield from _words(spec, writing.folder)
        yield from _rows_by_name(writing, spec)
        yield from _names(writing, spec)
        yield from _quantities(writing, spec)


def _kinds(writing: Writing, typed: Typed[Any]) -> Iterator[CompletionOption]:
    kind = kind_of(typed)
    for name, cls in usual_first(typed):
        yield CompletionOption(name, kind, name, typed.what, summary(cls))
    entries = writing.entries_around()
    if not entries.keys() - {typed.key} and not writing.after.strip(" }"):
        for option in typed_options(writing, typed):
            yield option._replace(insert=option.insert.removeprefix(f"{typed.key}: "))


def _words(spec: Spec[Any], folder: Path | None) -> Iterator[CompletionOption]:
    """Words of a fixed list, from the specification of the entry or its JSON Schema."""
    if isinstance(spec, SectionName):
        from torsionnet.report.plan.title_block import SECTIONS

        yield from (CompletionOption(name, "word", name, "section") for name in SECTIONS)
        return
    if isinstance(spec, Text) and spec.what in ("the name of a file", MODEL_NAME):
        library = library_models() if spec.what == MODEL_NAME else ()
        names = [*_files(folder, "*.yaml"), *library]
        yield from (CompletionOption(name, "word", name, spec.what) for name in names)
    schema: Any = spec.schema()
    for one in (schema, *schema.get("anyOf", ())):
        if one.get("type") == "boolean":
            yield from (CompletionOption(name, "word", name) for name in ("true", "false"))
        for value in (*one.get("enum", ()), *([one["const"]] if "const" in one else [])):
            yield CompletionOption(str(value), "word", str(value), "", spec.description)


def _rows_by_name(writing: Writing, spec: Spec[Any]) -> Iterator[CompletionOption]:
    """Names of the rows of the element's tables by name, as those of the gears for the one that is engaged."""
    if not isinstance(spec, Text) or spec.what != "the name of a gear":
        return
    owner = str(writing.place.path[-1]).rpartition(".")[0]
    element: Any = writing.names.table("elements").get(owner) if owner else writing.entries_around()
    kind = element.get("type") if isinstance(element, Mapping) else None
    if not isinstance(kind, str) or kind not in ELEMENT_TYPES:
        return
    from torsionnet.model.elements.gearbox import NEUTRAL

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
            yield from _words(spec, writing.folder)
        return
    is_pair = isinstance(spec, NodePair | PairOf)
    inner = spec if isinstance(spec, NodePair) else getattr(spec, "of", None)
    for kind, name in writing.names.for_spec(inner):
        yield CompletionOption(name, kind, f"[{name}, " if is_pair else f"[{name}]", kind)
    if not is_pair and isinstance(inner, Spec):
        yield from (option._replace(insert=f"[{option.insert}]") for option in _words(inner, writing.folder))


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
            first += [unit for one in used if one in DIMENSIONS for unit in units_of(str(one))]
    written = _written(_part_or_own(writing, parameter))
    own = _dimension(written)
    if own is not None:
        first.append(re.sub(r"^[-+.\d]+(?:[eE][-+]?\d+)?\s*", "", written.strip()))
    first += [unit for name, one in DIMENSIONS.items() if own is not None and one == own for unit in units_of(name)]
    return tuple(dict.fromkeys([*first, *usual_units()]))


def _part_or_own(writing: Writing, parameter: str) -> Any:
    """Value as written of a parameter of the part that is used, or of the model."""
    around = [one for one in writing.place.around if isinstance(one, Mapping) and "part" in one]
    if around and "use" in writing.place.path:
        table: Any = writing.names.parts.get(str(around[-1]["part"]), {}).get("parameters")
        return table.get(parameter) if isinstance(table, Mapping) else None
    return writing.names.table("parameters").get(parameter)


def _sizes(writing: Writing) -> Iterable[str]:
    """Sizes of the catalogue that the element names."""
    from torsionnet.model.catalogues.catalogue_reading import read_catalogue
    from torsionnet.model.catalogues.catalogue_values import shipped_catalogues

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
    from torsionnet.model.catalogues.catalogue_values import shipped_catalogues

    return [*_files(folder, "*.csv"), *shipped_catalogues()]


def _files(folder: Path | None, pattern: str) -> list[str]:
    """Names of the files in a folder that fit a pattern."""
    try:
        return sorted(path.name for path in folder.glob(pattern)) if folder else []
    except OSError:
        return []
