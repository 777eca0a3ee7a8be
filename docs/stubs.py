"""Stubs for type checkers and editors: names of the package that are imported on demand, and signatures of its entries.

``make generate`` writes the stubs into the package, beside what they describe.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from importlib import import_module
from inspect import Parameter, getdoc, signature
from pathlib import Path
from textwrap import fill, indent

import torsionnet as tn
import torsionnet.base.entries.accepted_types as accepted
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import Spec
from torsionnet.base.packages import TABLES
from torsionnet.base.units import expected_unit
from torsionnet.model.element_base.element_entries import NodeName, NodePair
from torsionnet.model.elements import Element, element_classes

ROOT = Path(tn.__file__).parents[1]
ELEMENT_TYPES = "torsionnet.model.elements.element_types"
ENTRY_CLASSES = "torsionnet.entry_classes"
HEAD = "# Written by `make generate`.\n"
WIDTH = 110
_PROTOCOLS = (accepted.QuantityWithUnit, accepted.GivenTransferFunction, accepted.GivenStateSpace)
_ACCEPTED = {*accepted.__annotations__, *(one.__name__ for one in _PROTOCOLS)}


def stubs() -> dict[Path, str]:
    """Texts of all stubs, by path."""
    for name in tn.__all__:
        getattr(tn, name)
    packages = {name: f"{name}.__init__" if hasattr(import_module(name), "__path__") else name for name in TABLES}
    named = {_path(module): package_stub(name) for name, module in packages.items()}
    return named | {_path(ELEMENT_TYPES): element_types_stub(), _path(ENTRY_CLASSES): entry_classes_stub()}


def _path(module: str) -> Path:
    return ROOT / f"{module.replace('.', '/')}.pyi"


# Names of packages


def package_stub(package: str) -> str:
    """Text of the stub of a package: its names, each imported from its module."""
    table = dict(TABLES[package])
    if package == "torsionnet":
        table |= {name: f"{ELEMENT_TYPES}:{name}" for name in element_classes()}
    others = public_entry_classes()
    table |= {name: f"{ENTRY_CLASSES}:{name}" for name in table if name in others}
    lines = [f"{_imported(home, name)} as {name}" for name, home in table.items()]
    names = sorted(table)
    if package == "torsionnet":
        lines.append("from torsionnet.base.version import __version__ as __version__")
        names = ["__version__", *names]
    listed = "".join(f'    "{name}",\n' for name in names)
    return f"{HEAD}{_lines(sorted(lines))}\n__all__ = [\n{listed}]\n"


def _imported(home: str, name: str) -> str:
    module, _, inside = home.partition(":")
    return f"from {module if inside else module.rpartition('.')[0]} import {inside or name}"


# Element types


def element_types_stub() -> str:
    """Text of the stub of all element types: their signatures, and the types of their entries."""
    return _classes_stub(element_classes())


def public_entry_classes() -> dict[str, type[Declared]]:
    """Classes of entries that packages offer, apart from element types, by name."""
    offered = {name: getattr(import_module(package), name) for package, table in TABLES.items() for name in table}
    return {
        name: one
        for name, one in offered.items()
        if isinstance(one, type) and issubclass(one, Declared) and not issubclass(one, Element) and one.specs()
    }


def entry_classes_stub() -> str:
    """Text of the stub of other classes with entries that packages offer, as an acquisition or a distribution."""
    return _classes_stub(public_entry_classes())


def _classes_stub(classes: Mapping[str, type[Declared]]) -> str:
    body = "\n".join(_class_stub(name, cls) for name, cls in sorted(classes.items()))
    imports: dict[str, set[str]] = defaultdict(set)

    def short(found: re.Match[str]) -> str:
        module, _, name = found[0].rpartition(".")
        if name not in classes:
            imports[module].add(name)
        return name

    body = re.sub(r"(?<![\w.])(?:torsionnet|collections|pathlib|typing)(?:\.\w+)+", short, body)
    imports[accepted.__name__] |= {name for name in _ACCEPTED if re.search(rf"\b{name}\b", body)}
    lines = ["import datetime"] if "datetime.date" in body else []
    lines += [f"from {module} import {', '.join(sorted(names))}" for module, names in sorted(imports.items())]
    lines += [f"from {cls.__module__} import {name} as _{name}" for name, cls in sorted(classes.items())]
    return f"{HEAD}{_lines(lines)}\n{body}"


def _class_stub(name: str, cls: type[Declared]) -> str:
    return "\n".join(
        [
            f"class {name}(_{name}):",
            indent(f'r"""{_description(cls)}\n"""', "    ", lambda line: bool(line.strip())),
            *_signatures(cls),
            "",
        ]
    )


def _description(cls: type[Declared]) -> str:
    text = (getdoc(cls) or "").partition("\nExamples\n")[0].strip()
    specs = dict(cls.specs())
    entries = "\n".join(
        fill(f"{name}: {_accepted_text(specs[name])}", WIDTH, subsequent_indent="    ")
        for name in signature(cls).parameters
        if name in specs
    )
    return f"{text}\n\nParameters\n----------\n{entries}".replace(f"{ELEMENT_TYPES}.", "").replace(
        f"{ENTRY_CLASSES}.", ""
    )


def _accepted_text(spec: Spec) -> str:
    unit = f" [{expected_unit(spec.dimension)}]" if isinstance(spec, QuantityKind) and spec.dimension != "1" else ""
    return f"{spec.description}{unit}"


def _signatures(cls: type[Declared]) -> Iterator[str]:
    """Text of the signatures of a class, with an overload for a catalogue, which may give required entries."""
    from_row = (
        []
        if not issubclass(cls, Element)
        else [name for name in cls.required() if not isinstance(dict(cls.specs())[name], NodeName | NodePair)]
    )
    if not from_row:
        yield _signature(cls, ())
        return
    yield "    @typing.overload"
    yield _signature(cls, ())
    yield "    @typing.overload"
    yield _signature(cls, from_row)


def _signature(cls: type[Declared], from_row: Iterable[str]) -> str:
    """Text of the constructor of a class, with entries from ``from_row`` optional."""
    specs = dict(cls.specs())
    given = ["self"]
    parameters = list(signature(cls).parameters.values())
    for before, parameter in zip([None, *parameters], parameters, strict=False):
        if parameter.kind is Parameter.KEYWORD_ONLY and (before is None or before.kind is not Parameter.KEYWORD_ONLY):
            given.append("*")
        name, default = parameter.name, parameter.default
        annotation = specs[name].accepted if name in specs else "str"
        must = default is Parameter.empty
        if default is None or name in from_row:
            annotation += " | None"
        if name == "catalogue" and from_row:
            annotation, must = specs[name].accepted, True
        given.append(f"{name}: {annotation}{'' if must else f' = {default!r}'}")
    lines = "".join(f"        {one},\n" for one in given)
    return f"    def __init__(\n{lines}    ) -> None: ..."


def _lines(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def write_stubs(root: Path) -> None:
    """Write all stubs into the package below a folder."""
    for path, text in stubs().items():
        place = root / path.relative_to(ROOT)
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
