"""Machines of a drivetrain as a report lists them: data sheet values in units of engineers, and their sources."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.scalars import QuantityKind, Value
from torsionnet.base.expressions import Expression
from torsionnet.base.number_text import aligned_numbers
from torsionnet.base.phrases import joined, phrase
from torsionnet.machinery.excitations.harmonic_torque import PropellerTorque
from torsionnet.machinery.excitations.reciprocating_engine import conditions_running_alone
from torsionnet.machinery.orders.engine_angles import EngineAngle
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.model.damping import MEASURES, DampingMeasure, convert_damping
from torsionnet.model.element_base.element_entries import Teeth
from torsionnet.model.load.external_torques import ENGINE
from torsionnet.model.overview import given
from torsionnet.report.document_tree import Block, Cell, Heading, Inline, Listing, TableBlock, Text
from torsionnet.report.report_data import ReportData
from torsionnet.report.report_tables import table
from torsionnet.report.report_text import as_words, capital, quantity_text, symbol_or_words, unit

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.machinery.excitations import OrderExcitation
    from torsionnet.model.elements import Element


MACHINES = {
    "propeller": "Propeller",
    "induction_machine": "Induction machine",
    "synchronous_machine": "Synchronous machine",
    "grid_generator": "Generator",
    "gear": "Gear",
    "planetary": "Planetary gear",
    "gearbox": "Gearbox",
    "final_drive": "Final drive",
    "belt": "Belt",
    "chain_drive": "Chain",
    "flexible_coupling": "Coupling",
    "hysteretic_spring": "Coupling",
    "clutch": "Clutch",
    "fluid_coupling": "Fluid coupling",
    "torque_converter": "Torque converter",
    "dual_mass_flywheel": "Dual-mass flywheel",
    "viscous_damper": "Viscous damper",
    "tuned_damper": "Tuned damper",
    "spring_damper": "Spring damper",
    "pendulum_absorber": "Pendulum absorber",
}
"""Words for the types of elements that are machines of an installation, in the order of the list."""
ROTORS = ("propeller", "electric_machine", "induction_machine", "synchronous_machine", "grid_generator")
"""Types of elements and excitations that are a whole machine at a node that drives or absorbs."""
COUPLING_RULE = "coupling"
"""Type of the limit that makes a coupling of any spring."""
FOLLOWING = ("torque", "speed")
"""Entries of a propeller that follow the operating point and are no data of its sheet."""
LABELS = {
    "archer": "Archer's factor",
    "second_inertia": "inertia of the second half",
    "power_per_area": "power per area",
}
"""Words for entries, in place of their names."""


def machines(model: Drivetrain) -> Iterator[tuple[str, Text, str]]:
    """Yield the machines of a drivetrain, prime movers first: what each is, its data, and where these come from."""
    limits = model.definition.limits.values()
    couplings = {getattr(limit, "element", "") for limit in limits if limit.kind == COUPLING_RULE}
    elements = [
        element
        for element in model.definition.elements.values()
        if element.kind in MACHINES or element.name in couplings
    ]
    for name, excitation in model.definition.excitations.items():
        words = {"electric_machine": "Electric machine"}.get(excitation.kind, "")
        if excitation.kind == ENGINE:
            words = "Compressor" if excitation.absorbs else "Engine"
        if words:
            yield _titled(words, name), _joined(_of_excitation(model, excitation)), ""
    order = [*MACHINES, ""]
    for element in sorted(elements, key=lambda element: order.index(element.kind if element.kind in MACHINES else "")):
        head = _titled(MACHINES.get(element.kind, "Coupling"), element.name)
        head += "" if element.enabled else " (switched off unless a condition switches it on)"
        yield head, _joined(_of_element(model, element)), _source(model, element)
    yield from _loads(model)


def _loads(model: Drivetrain) -> Iterator[tuple[str, Text, str]]:
    """Yield rotors that the load drives or brakes where no machine of the list is, as that of a generator."""
    load = model.definition.load
    places = {*load.by_place, *load.driven_by} if load else set()
    covered = {
        node
        for element in model.definition.elements.values()
        if element.kind in ROTORS
        for node in element.ports.values()
    }
    machines_there = [machine for machine in model.definition.excitations.values() if machine.kind in (ENGINE, *ROTORS)]
    covered = covered.union(*(machine.nodes for machine in machines_there))
    for element in model.definition.elements.values():
        node = getattr(element, "node", None)
        if element.kind == "inertia" and node in places - covered:
            yield capital(as_words(element.name)), _joined(_of_element(model, element)), _source(model, element)


def _titled(words: str, name: str) -> str:
    """Heading of a machine: its kind, and its name unless the kind says it."""
    return words if as_words(name) in (words.lower(), *words.lower().split()) else f"{words} {as_words(name)}"


def _joined(parts: Iterator[tuple[Inline, str]]) -> Text:
    """Text of labels and values one after the other, separated by semicolons."""
    inlines: list[Inline] = []
    for label, value in parts:
        inlines += ["; "] * bool(inlines) + ([label, " ", value] if value else [label])
    text = tuple(inlines)
    return (capital(text[0]), *text[1:]) if text and isinstance(text[0], str) else text


def _of_excitation(model: Drivetrain, machine: Any) -> Iterator[tuple[Inline, str]]:
    """Labels and values of an engine, compressor or electric machine by its excitation."""
    if machine.kind == ENGINE:
        yield phrase("{count} cylinders", count=len(machine.cylinders)), ""
        if not machine.absorbs:
            yield "four-stroke" if machine.cycle == 4 else "two-stroke", ""
        if machine.firing_order:
            yield "firing order", "-".join(map(str, machine.firing_order))
        yield "bore", quantity_text(machine.bore, "length")
        yield "stroke", quantity_text(machine.stroke, "length")
        yield "rod", quantity_text(machine.rod_length, "length")
        yield "reciprocating mass of one cylinder", quantity_text(machine.reciprocating_mass, "mass")
    if getattr(machine, "pole_pairs", None):
        yield "poles", str(2 * machine.pole_pairs)
    if getattr(machine, "rated_torque", None):
        yield "rated torque", quantity_text(machine.rated_torque, "torque")
    yield from _rating(model, machine)


def _rating(model: Drivetrain, machine: OrderExcitation) -> Iterator[tuple[Inline, str]]:
    """Label and value of the power that a machine states at the rated speed, where it states one."""
    rating, external = machine.rating, model.external_torques
    ratio = external.ratios.get(machine.shaft)
    if rating is None or not ratio or not external.rated_speed:
        return
    speed = abs(ratio) * external.rated_speed
    what = "indicated power by its pressures" if rating.shares[0] < 1 and rating.power is None else "stated power"
    power = quantity_text(abs(rating.at(speed)[0]), "power")
    yield what, phrase("{value} at {speed}", value=power, speed=quantity_text(speed, "speed"))


def _of_element(model: Drivetrain, element: Element) -> Iterator[tuple[Inline, str]]:
    """Labels and values of an element with the limits on it, and of a propeller's excitation."""
    node = getattr(element, "node", None)
    for propeller in model.definition.excitations.values():
        if isinstance(propeller, PropellerTorque) and element.kind == propeller.kind and propeller.shaft == node:
            yield phrase("{count} blades", count=propeller.blades), ""
            yield phrase("fixed pitch") if propeller.pitch == "fixed" else phrase("controllable pitch"), ""
            torque = quantity_text(propeller.torque, "torque")
            # P = M omega at rated speed.
            power = quantity_text(propeller.torque * propeller.rated, "power")
            rated = quantity_text(propeller.rated, "speed")
            yield "rated torque", phrase("{value} at {speed} ({power})", value=torque, speed=rated, power=power)
    defaults = element.defaults()
    for name, spec, value in given(element):
        if element.kind == "propeller" and name in FOLLOWING:
            continue
        if isinstance(value, DampingMeasure):
            number = float(value.value.evaluate(model.exact_values))
            at = (
                phrase(" at {frequency:g} Hz", frequency=float(value.at.evaluate(model.exact_values)))
                if value.at is not None
                else ""
            )
            words = MEASURES[value.measure].name
            size = quantity_text(number, MEASURES[value.measure].dimension)
            yield words, joined("", (size, at, _as_loss_factor(value, number)))
        elif isinstance(spec, QuantityKind) and isinstance(value, Expression):
            number = float(value.evaluate(model.exact_values))
            if number:
                yield LABELS.get(name, as_words(name)), quantity_text(number, spec.dimension)
        elif isinstance(spec, Teeth) and value:
            yield as_words(name), " : ".join(map(str, value)).replace("-", "−")
        elif value not in (defaults.get(name, ()), None, (), "") and not isinstance(value, str | bool):
            yield as_words(name), "from a table" if not isinstance(value, int) else str(value)
    for limit in model.definition.limits.values():
        if getattr(limit, "element", None) == element.name:
            absent = limit.defaults()
            for name, spec in limit.specs():
                value = getattr(limit, name)
                if isinstance(spec, Value) and value is not None and value != absent.get(name):
                    yield LABELS.get(name) or symbol_or_words(name), quantity_text(value, spec.dimension)


def _as_loss_factor(damping: DampingMeasure, number: float) -> str:
    """Text with the loss factor of a damping given by another measure, as the mass-elastic table has it; or nothing."""
    if damping.measure in ("eta", "c"):
        return ""
    return phrase(" (loss factor {eta:.4g})", eta=convert_damping(number, damping.measure, "eta"))


def _source(model: Drivetrain, element: Element) -> str:
    """Text of where the values of an element come from: its remark, its parameters', catalogue, and its limits'."""
    labels = {LABELS.get(name, as_words(name)) for name, _, _ in given(element)}
    names = {name for _, _, value, _ in element.expressions() for name in value.names if "." not in name}
    known = {
        name: parameter
        for name, parameter in model.parameter_definitions.items()
        if name in names and parameter.by is None
    }
    texts = [
        element.description,
        *(parameter.description for parameter in known.values() if parameter.description not in labels),
    ]
    texts += [f"catalogue {element.catalogue}"] if element.catalogue is not None else []
    for limit in model.definition.limits.values():
        source = getattr(limit, "source", "")
        if getattr(limit, "element", None) == element.name and source != limit.defaults().get("source"):
            texts.append(source)
    return "; ".join(dict.fromkeys(filter(None, texts)))


# Texts and tables of a report on several engines: unknown angles between them, and running on one of them.


def engine_remarks(subject: ReportData) -> list[Block]:
    """Block with a list of sentences on angles between engines and on running on one engine.

    Empty for a model with one engine.
    """
    runs = subject.order_responses if subject.order_outputs else ()
    notes = dict.fromkeys(note for run in runs for note in run.engine_notes)
    conditions = [(case.title, case.drivetrain.definition.excitations) for case in subject.cases]
    remarks = [
        *(f"{note[0].upper()}{note[1:]}." for note in notes),
        *(
            phrase("Running on {engine} alone: examined in {names}.", engine=engine, names=", ".join(names))
            if names
            else phrase("Running on {engine} alone: not examined.", engine=engine)
            for engine, names in conditions_running_alone(conditions).items()
        ),
    ]
    return [Listing(tuple((as_words(remark),) for remark in remarks))] if remarks else []


def engine_angle_tables(subject: ReportData, name: str) -> list[TableBlock]:
    """Tables of the largest and smallest half range of an output by the angles between engines."""
    runs = [
        (case.title, run, run.output(name), run.half_range[:, run.output(name)])
        for case, run in zip(subject.cases, subject.order_responses, strict=True)
        if isinstance(run, WorstResponse) and run.angles
    ]
    if not runs:
        return []
    channel = runs[0][1].outputs[runs[0][2]]
    scale, shown = subject.conventions.scale(channel.unit), unit(subject.conventions.unit(channel.unit))
    columns = (
        Heading("Configuration"),
        Heading("Speed", "rpm", numeric=True),
        Heading("Largest half range", shown, numeric=True),
        Heading("Where it is largest"),
        Heading("Smallest half range", shown, numeric=True),
        Heading("Where it is smallest"),
    )
    worst = [int(sizes.argmax()) for _, _, _, sizes in runs]
    # At the same speeds: what the best angles between the engines would leave there.
    least = [run.least_at(at, name) for (_, run, _, _), at in zip(runs, worst, strict=True)]
    cells: list[list[Cell]] = [
        [configuration for configuration, _, _, _ in runs],
        list(aligned_numbers([float(run.rpm[at]) for (_, run, _, _), at in zip(runs, worst, strict=True)])),
        list(aligned_numbers([float(sizes[at]) * scale for (_, _, _, sizes), at in zip(runs, worst, strict=True)])),
        [_words(run.angles, at, place) for (_, run, place, _), at in zip(runs, worst, strict=True)],
        list(aligned_numbers([float(smallest.half_range[0, 0]) * scale for smallest in least])),
        [_words(smallest.angles, 0, 0) for smallest in least],
    ]
    return [table((symbol_or_words(name), ": by the angle between engines"), columns, list(zip(*cells, strict=True)))]


def _words(angles: tuple[EngineAngle, ...], speed: int, output: int) -> str:
    return as_words(", ".join(angle.at(speed, output) for angle in angles))
