"""Element type for a maker's mass-elastic sheet, expanded to inertias, shafts and gears."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar

from torsionnet.base.entries.spec import EntryError, Plural, Renaming, Schema, entry
from torsionnet.base.errors import Fault, got, nearest, question
from torsionnet.base.expression_reading import scalar
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.plain_names import free_name
from torsionnet.model.damping import DampingMeasure
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import TURNING_NODE
from torsionnet.model.element_base.laws import GROUND, Part, Row, Values, make_row
from torsionnet.model.elements.flexible_couplings import HystereticSpring
from torsionnet.model.elements.gears import Gear, RigidCoupling
from torsionnet.model.elements.masses_and_springs import Damper, Inertia, Lock, Spring
from torsionnet.model.elements.shaft import Shaft
from torsionnet.model.sheets.mass_elastic_sheet import MassElasticSheet, SheetEntry
from torsionnet.model.sheets.sheet_rows import SheetLink, SheetMass

LARGEST_RATIO_TERM = 10**6
"""Largest numerator and denominator of a speed ratio that is written as a fraction, above as a decimal number."""


class Stations(Plural[tuple[tuple[str, str], ...]]):
    """Entry that puts masses of a sheet on nodes of the model: ``{flywheel: fly}``."""

    absent: ClassVar[Any] = ()

    def coerce(self, raw: object) -> tuple[tuple[str, str], ...]:
        if isinstance(raw, tuple):
            return raw
        if not isinstance(raw, Mapping) or not raw:
            raise EntryError(
                f"expected {{mass of the sheet: node}}, as {{flywheel: fly}}, {got(raw)}", kind="wrong-form"
            )
        stations = []
        for mass, node in raw.items():
            try:
                stations.append((str(mass), TURNING_NODE.coerce(node)))
            except EntryError as error:
                raise EntryError(error.fault.under(mass)) from None
        return tuple(stations)

    def renamed(self, value: Any, names: Renaming) -> Any:
        return tuple((mass, names.node(node)) for mass, node in value)

    def plain(self, value: Any) -> dict[str, str]:
        return dict(value)

    def schema(self) -> Schema:
        return {"type": "object", "additionalProperties": {"type": "string"}, "description": self.description}

    @property
    def accepted(self) -> str:
        return "collections.abc.Mapping[str, str] | tuple[tuple[str, str], ...]"


@register
@dataclass(frozen=True, eq=False, repr=False)
class MassElastic(Element):
    """A maker's mass-elastic sheet: inertias, shafts, damping and gears out of a table beside the model file.

    The columns are known by their headings, with units: inertia, stiffness or compliance to the next mass, damping of a
    mass (to ground) and of a shaft, diameters, speed ratio n (speed of the mass over that of the first), names. A mass
    called ``Cyl. 1`` becomes the inertia and the node ``engine.Cyl_1`` of an element ``engine``, the shaft after it
    ``engine.Cyl_1_to_Cyl_2``; ``at`` puts masses on nodes of the model. Values that the sheet calls referred are made
    real: J = J_ref/n^2, k = k_ref/n^2, c = c_ref/n^2. Where n changes from one mass to the next there is a gear at the
    end of the shaft, of ratio n_first/n_second.

    Examples
    --------
    >>> from torsionnet.base.delimited.cell_grid import parse_grid
    >>> from torsionnet.model.sheets.mass_elastic_sheet import parse_sheet
    >>> sheet = parse_sheet(parse_grid(["mass;J [kg m²];k [MNm/rad]", "Cyl. 1;52;36", "Flywheel;780;"], "engine.csv"))
    >>> engine = MassElastic("engine", table=sheet, at={"flywheel": "fly"})
    >>> engine.nodes_of_masses
    {'Cyl_1': 'engine.Cyl_1', 'Flywheel': 'fly'}
    """

    kind: ClassVar[str] = "mass_elastic"
    glyph: ClassVar[str] = "sheet"
    sign: ClassVar[str] = "positive when the drivetrain drives the mass at the first port in the positive sense"

    table: MassElasticSheet = entry(SheetEntry("the sheet: a file with columns, beside the model file"))
    at: tuple[tuple[str, str], ...] = entry(
        Stations("masses of the sheet that are on nodes of the model, as {flywheel: fly}"), ()
    )

    def contradictions(self) -> list[Fault]:
        masses, taken = self.table.masses, list[str]()
        faults: list[Fault] = []
        for mass, node in self.at:
            name = _mass_called(mass, masses)
            if name is None:
                known = [listed.name for listed in masses]
                meant = nearest(mass, known)
                rest = question(meant) or f"; there are {', '.join(known)}"
                text = f'the sheet has no mass "{mass}"{rest}'
                faults.append(Fault(text, ("at", mass), on_key=True, about=mass, meant=meant, kind="unknown-name"))
            elif name in taken:
                faults.append(
                    Fault(
                        f'mass "{name}" is put on two nodes; keep one of them',
                        ("at", mass),
                        on_key=True,
                        kind="repeated-name",
                    )
                )
            if sum(node == other for _, other in self.at) > 1:
                text = phrase('two masses are on node "{}"; give each a node of its own', ModelName(node))
                faults.append(Fault(text, ("at", mass), kind="same-node"))
            taken += [name] if name else []
        return faults

    @property
    def nodes_of_masses(self) -> dict[str, str]:
        """Node of every mass of the sheet, by the name of the mass."""
        given = {_mass_called(mass, self.table.masses): node for mass, node in self.at}
        return {mass.name: given.get(mass.name, f"{self.name}.{mass.name}") for mass in self.table.masses}

    @property
    def ports(self) -> dict[str, str]:
        return {str(_mass_called(mass, self.table.masses)): node for mass, node in self.at}

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        own = set(self.ports.values())
        nodes = (node for element in self.expanded() for node in element.ports.values())
        return tuple(node for node in dict.fromkeys(nodes) if node not in own and node != GROUND)

    def expanded(self) -> tuple[Element, ...]:
        """Inertias, shafts, dampers and gears of the sheet as elements."""
        elements = tuple(sheet_elements(self.table, self.nodes_of_masses, f"{self.name}."))
        return elements if self.enabled else tuple(replace(element, enabled=False) for element in elements)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return tuple(part for element in self.expanded() for part in element.parts(value))

    def twist(self, value: Values) -> Row:
        """Weight of the first mass's angle, because a whole sheet has no twist."""
        del value
        return make_row([(next(iter(self.nodes_of_masses.values())), 1)])


def _mass_called(wanted: str, masses: tuple[SheetMass, ...]) -> str | None:
    """Name of the mass in a sheet that is given by its name, number or label, regardless of case.

    None without a match.
    """
    words = [(mass.name, mass.name) for mass in masses] + [(mass.label, mass.name) for mass in masses]
    words += [(mass.number, mass.name) for mass in masses if mass.number]
    exact = [name for word, name in words if word == wanted]
    return next(iter(exact or [name for word, name in words if word.casefold() == wanted.casefold()]), None)


def sheet_elements(sheet: MassElasticSheet, nodes: Mapping[str, str], prefix: str = "") -> Iterator[Element]:
    """Elements for the masses and connections of a sheet, with names that begin with ``prefix``."""
    ratios = {mass.name: mass.ratio for mass in sheet.masses}
    places = {**nodes, GROUND: GROUND}
    taken = {*ratios, *(link.name for link in sheet.links)}
    for mass in sheet.masses:
        node, name = nodes[mass.name], f"{prefix}{mass.name}"
        said = mass.label if mass.label != mass.name else ""
        if mass.inertia is not None and mass.inertia.si:
            yield Inertia.from_entries(name, node=node, inertia=mass.inertia.raw, description=said)
        if mass.damping is not None and mass.damping.si:
            yield Damper.from_entries(
                f"{prefix}{free_name(f'{mass.name}_damping', taken)}", nodes=(node, GROUND), damping=mass.damping.raw
            )
    for link in sheet.links:
        ratio = ratios[link.first] / ratios.get(link.second, ratios[link.first])
        yield from _connection(link, (places[link.first], places[link.second]), ratio, prefix)


def _connection(link: SheetLink, nodes: tuple[str, str], ratio: Fraction, prefix: str) -> Iterator[Element]:
    """Elements of a shaft or rigid connection between two masses, with a gear at its end where the speeds differ."""
    name, (first, second) = f"{prefix}{link.name}", nodes
    rigid = link.stiffness is None and link.length is None
    if ratio == 1:
        yield _shaft(link, name, nodes) if not rigid else _joint(name, nodes)
        return
    start = first
    if not rigid:
        start = f"{name}_end"
        yield _shaft(link, name, (first, start))
    plain = max(abs(ratio.numerator), ratio.denominator) < LARGEST_RATIO_TERM
    yield Gear.from_entries(
        f"{name}_gear" if not rigid else name, nodes=(start, second), ratio=ratio if plain else float(ratio)
    )


def _joint(name: str, nodes: tuple[str, str]) -> Element:
    return Lock(name, node=nodes[0]) if nodes[1] == GROUND else RigidCoupling(name, nodes=nodes)


def _shaft(link: SheetLink, name: str, nodes: tuple[str, str]) -> Element:
    """Spring of a shaft in a mass-elastic sheet, with the section for stresses.

    A shaft without inertia where only dimensions are given.
    """
    damping = link.damping.raw if link.damping is not None else 0
    section: dict[str, Any] = {} if link.outer is None else {"outer_diameter": link.outer.raw}
    section |= {"inner_diameter": link.inner.raw} if link.inner is not None and section and link.inner.si else {}
    if link.stiffness is None:
        assert link.length is not None
        return Shaft.from_entries(name, nodes=nodes, length=link.length.raw, inertia="none", damping=damping, **section)
    if not link.stiffness.si:
        return Damper.from_entries(name, nodes=nodes, damping=damping)
    if link.loss is not None:
        measure, value = link.loss
        losses = scalar(value.raw) if measure == "eta" else DampingMeasure(measure, scalar(value.raw), None)
        return HystereticSpring.from_entries(name, nodes=nodes, stiffness=link.stiffness.raw, loss_factor=losses,
                                damping=damping, **section)  # fmt: skip
    return Spring.from_entries(name, nodes=nodes, stiffness=link.stiffness.raw, damping=damping, **section)
