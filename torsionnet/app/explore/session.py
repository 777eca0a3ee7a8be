"""Model of the explore page with its start state and test, which the server keeps between requests."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from threading import Lock
from typing import Any

from torsionnet.app.explore.over_speed import limited_output, overlay_data, runs
from torsionnet.app.explore.sliders import all_point_rows, point_rows, point_settings, with_balance
from torsionnet.app.explore.state import State
from torsionnet.base.entries.scalars import QuantityKind, read_scalar
from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.base.expressions import Number
from torsionnet.base.registers import RecentResults
from torsionnet.drivetrain import Drivetrain, loads
from torsionnet.linear.dynamic_stiffness.transfer_request import usable_channels
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.responses.grid import opening_range
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.model.channels import UNITS, Sensor
from torsionnet.model.configurations import parse_choice
from torsionnet.model.element_base.round_section import section_fault
from torsionnet.model.elements import GROUND
from torsionnet.model.files.library import decode
from torsionnet.model.files.reader import find_model
from torsionnet.model.files.value_editing import changed_text, place_of

# Outputs and inputs that the explore page offers for responses: sensors, nodes, inputs and torques on nodes.

TWISTING = ("shaft", "spring", "clearance")
"""Glyphs of the elements whose torque the page offers as an output."""
MOTIONS = ("angle", "velocity", "acceleration", "twist")
"""Quantities of sensors, all of motion, that the page takes first as the output of a response."""


@dataclass(frozen=True)
class ResponseChoice:
    """Frequency response chosen by the names of its output and input.

    Examples
    --------
    >>> read_pair("torque(gearbox, output_shaft)/T_M")
    ResponseChoice(output='torque(gearbox, output_shaft)', input='T_M')
    """

    output: str
    input: str

    def __str__(self) -> str:
        return f"{self.output}/{self.input}"


def read_pair(text: str) -> ResponseChoice:
    """Output and input of a response, read from ``OUTPUT/INPUT``; UsageError where the text has another form."""
    output, slash, into = (part.strip() for part in text.partition("/"))
    if not (slash and output and into) or "/" in into:
        raise UsageError(
            f'a transfer function is written OUTPUT/INPUT, as in theta_1/T_M; got "{text}"', kind="wrong-form"
        )
    return ResponseChoice(output, into)


def default_pair(rig: Drivetrain, overlay: FrequencyResponse | None = None) -> ResponseChoice:
    """Names of output and input of the first response shown, the measured ones if the model has them, else its first.

    Examples
    --------
    >>> import torsionnet as tn
    >>> print(default_pair(tn.load("amt_rig")))
    theta_1/T_M
    """
    if overlay is not None:
        measured = ResponseChoice(overlay.outputs[0].name, overlay.inputs[0].name)
        if measured.output in {*rig.sensors, *rig.nodes} and measured.input in {*rig.inputs, *rig.sensors, *rig.nodes}:
            return measured
    try:
        inputs, sensors = usable_channels(rig)
        moving = rig.assembly.kinematics.coordinates or rig.nodes
    except TorsionnetError:  # an operating point out of balance, of which the page tells
        inputs, sensors, moving = list(rig.inputs), list(rig.sensors), rig.nodes
    motions = [name for name in sensors if rig.sensors[name].quantity in MOTIONS]
    return ResponseChoice([*motions, *sensors, *moving][0], [*inputs, *moving][0])


def choices(rig: Drivetrain, pairs: Sequence[ResponseChoice], over_speed: Sequence[str] = ()) -> dict[str, Any]:
    """Groups of outputs and inputs that the page offers, and the names of measured inputs and excitations.

    ``pairs`` and ``over_speed`` are the responses and the outputs asked for by name. Of a model that runs, torques in
    shafts and springs and stresses in shafts are outputs, too: they are what is examined over speed.
    """
    sensors = [(name, _what(sensor)) for name, sensor in rig.sensors.items()]
    nodes = [(node, f"angle of {node}") for node in rig.nodes if node not in rig.sensors]
    inputs = [(name, str(entry)) for name, entry in rig.inputs.items()]
    torques = [(node, f"torque on {node}") for node in rig.nodes if node not in {*rig.inputs, *rig.sensors}]
    known = ({name for name, _ in (*sensors, *nodes)}, {name for name, _ in (*inputs, *sensors, *torques)})
    outputs = (*over_speed, *(pair.output for pair in pairs))
    asked = (_others(outputs, known[0]), _others((pair.input for pair in pairs), known[1]))
    inside, sheared = ([offered for offered in group if offered[0] not in outputs] for group in _in_elements(rig))
    return {
        "outputs": _groups(
            ("sensors", sensors),
            ("asked for", asked[0]),
            ("torques in elements", inside),
            ("stresses in shafts", sheared),
            ("angles of nodes", nodes),
        ),
        "inputs": _groups(("inputs", inputs), ("measured", [*sensors, *asked[1]]), ("torques on nodes", torques)),
        "measured": [*rig.sensors, *(name for name, _ in asked[1])],
        "excitations": [*rig.inputs, *(() if rig.inputs else rig.nodes)],
    }


def _in_elements(rig: Drivetrain) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Names and labels of the torques in shafts and springs between nodes, and of the stresses in shafts."""
    every = rig.elements.values() if runs(rig) else ()
    twisting = [element for element in every if element.glyph in TWISTING and GROUND not in element.ports.values()]
    shafts = [element for element in twisting if not section_fault(element)]
    torques = [Sensor("torque", element.name) for element in twisting]
    stresses = [Sensor("stress", shaft.name) for shaft in shafts]
    return [(str(sensor), _what(sensor)) for sensor in torques], [(str(sensor), _what(sensor)) for sensor in stresses]


def _what(sensor: Sensor) -> str:
    return f"{sensor}, {UNITS[sensor.quantity]}"


def _others(names: Iterable[str], known: set[str]) -> list[tuple[str, str]]:
    return [(name, name) for name in dict.fromkeys(names) if name not in known]


def _groups(*groups: tuple[str, list[tuple[str, str]]]) -> list[dict[str, Any]]:
    return [
        {"label": label, "entries": [{"name": name, "what": what} for name, what in entries]}
        for label, entries in groups
        if entries
    ]


NO_POINT = (
    "Laws of motion are linear at rest: give torques under operating_point: of the model, or start with "
    '--set "operating_point.torque.NODE=200 N*m", to move them here.'
)
"""Words instead of sliders for the operating point of a model that has none."""
BAND_WITHOUT_MODES = (1.0, 1000.0)
"""Frequency band in Hz of a page whose operating point is out of balance; most torsional vibrations lie in it."""
MOST_NUMBERS = 200
"""Number of numbers of elements that the page offers to make parameters of; nobody looks through more."""
MOST_MODES, MANY_NODES = 40, 120
"""Number of lowest modes calculated of models with more nodes than the second number.

All modes of such a model would take longer than the drag of a slider.
"""
MOST_SURVEYED = 24
"""Number of configurations whose modes are calculated to find the first frequency band; each costs a solution."""


class SharedModes:
    """Modes of recent states with the notes on them, solved once for results and for pictures, which run in threads."""

    def __init__(self) -> None:
        self._recent, self._solving = RecentResults(), Lock()

    def once(self, state: State, solve: Callable[[], tuple[Modes, list[str]]]) -> tuple[Modes, list[str]]:
        """Modes and notes of a state; whoever asks while they are solved waits for them."""
        key = (tuple(state.choice.items()), tuple(state.values.items()))
        with self._solving:
            return self._recent.once(tuple, key, solve, lambda found: 3 * found[0].shapes.nbytes)


@dataclass(frozen=True, eq=False)
class Session:
    """Model that the page shows, with its text and the state that the page begins with.

    Attributes
    ----------
    model : str
        Name or path on the command line.
    file : str
        Name of its file, without folders.
    text : str
        The text of that file.
    base : Drivetrain
    start : State
    pairs : tuple of ResponseChoice
        Responses asked for by name.
    over_speed : tuple of str
        Outputs over speed asked for by name.
    overlay : FrequencyResponse, optional
        A test.
    overlay_name : str
    folder : Path, optional
        Where files that the text names lie.
    measured : Path, optional
        A file of measured orders.
    """

    model: str
    file: str
    text: str
    base: Drivetrain
    start: State
    pairs: tuple[ResponseChoice, ...] = ()
    over_speed: tuple[str, ...] = ()
    overlay: FrequencyResponse | None = None
    overlay_name: str = ""
    folder: Path | None = None
    measured: Path | None = None
    point: Mapping[str, Any] = field(default_factory=dict)
    """Operating point in place of that of the file."""
    pictures: RecentResults = field(default_factory=RecentResults, repr=False)
    """Recent schematics and motions of modes, which many states share."""
    modes: SharedModes = field(default_factory=SharedModes, repr=False)
    _chosen: dict[str, Drivetrain] = field(default_factory=dict, repr=False)

    def model_in(self, choice: Mapping[str, str]) -> Drivetrain:
        """Drivetrain of the page in a configuration, with the parameter values of its file."""
        name = ",".join(f"{axis}={alternative}" for axis, alternative in choice.items())
        if name not in self._chosen:
            self._chosen[name] = self.base.configured(name) if name else self.base
        return self._chosen[name]

    def values_of(self, state: State) -> dict[str, Any]:
        """Values of a state, with the torques that follow others, without the sliders that its configuration hides."""
        plain, values = self.model_in(state.choice), dict(state.values)
        if not point_settings(values, plain):
            return values
        shown = {row.name for row in point_rows(plain)}
        hidden = {row.name for row in all_point_rows(self.base)} - shown
        return with_balance(plain, {name: value for name, value in values.items() if name not in hidden})

    def model_for(self, state: State) -> Drivetrain:
        """Drivetrain in a state's configuration with its values; UsageError for an expression as a value."""
        plain = self.model_in(state.choice)
        values = self.values_of(state)
        changed = plain.configured(**values) if values else plain
        settings = point_settings(values, plain)
        for name in values:
            if (
                read_scalar(settings[name]).names
                if name in settings
                else changed.parameter_definitions[name].is_derived
            ):
                raise UsageError(
                    f"{name}: expected a number with its unit; expressions of parameters belong in the model file",
                    kind="not-a-number",
                )
        return changed

    def given_values(self, state: State) -> dict[str, Any]:
        """Values that differ from the file's: those of a state, and the operating point of the command line."""
        return {**self.point, **self.values_of(state)}

    def with_defaults(self, state: State) -> State:
        """State of the page with the response and the excitation that an empty name stands for.

        Of a state whose input is no sensor the excitation is empty.
        """
        output, into = state.output or self.start.output, state.input or self.start.input
        offered = choices(self.base, self.pairs, self.over_speed)
        if into not in offered["measured"]:
            return replace(state, output=output, input=into, excitation="")
        excitation = state.excitation or next(iter(offered["excitations"]))
        return replace(state, output=output, input=into, excitation=excitation)

    def describe(self) -> dict[str, Any]:
        """Data of the model that stay the same while the page is open, for JSON."""
        return {
            "name": self.base.name,
            "source": self.base.source,
            "description": self.base.description,
            "file": self.file,
            "parameters": [
                {"name": name, "description": own.description} for name, own in self.base.parameter_definitions.items()
            ],
            "operating_point": self._operating_point(),
            "numbers": list(islice(_numbers(self.base), MOST_NUMBERS)),
            "axes": {axis: list(names) for axis, names in self.base.axes.items()},
            "choices": choices(self.base, self.pairs, self.over_speed),
            "runs": runs(self.base),
            "start": self.start.to_data(),
            "overlay": self.overlay_name,
            "measured": self.measured.name if self.measured else "",
        }

    def _operating_point(self) -> dict[str, Any]:
        """Names and labels of sliders of the operating point in any configuration; words where there are none."""
        rows = all_point_rows(self.base)
        hint = "" if rows or self.base.definition.tangents is None else NO_POINT
        return {"rows": [{"name": row.name, "label": row.label} for row in rows], "hint": hint}

    def overlay_for(self, state: State) -> dict[str, Any] | None:
        """Measured response of a state's output and input as JSON data in Hz, SI and degrees; None without one."""
        return overlay_data(self.overlay, self.with_defaults(state))

    def changed_file_text(self, state: State) -> str:
        """Text of the model file with the parameter values of a state.

        A value that the configuration chosen sets is changed there, any other one in the table of parameters.
        """
        changed = self.model_for(state).parameter_definitions
        changes = {
            place_of(self.base.definition, state.choice, name): changed[name].value
            if name in changed
            else read_scalar(value)
            for name, value in self.given_values(state).items()
        }
        return changed_text(self.text, self.base.definition, changes, self.file, self.folder)


def _numbers(rig: Drivetrain) -> Iterator[dict[str, str]]:
    """Numbers of elements that could become parameters: element, entry, symbol and what is written."""
    for name, element in rig.definition.elements.items():
        for entry, (spec, value) in element.scalars().items() if "." not in name else ():
            if isinstance(spec, QuantityKind) and isinstance(value, Number) and value.value and spec.symbol:
                yield {"element": name, "entry": entry, "symbol": spec.symbol, "written": str(value)}


def open_session(
    model: str | os.PathLike[str],
    configuration: str = "",
    settings: Mapping[str, str] | None = None,
    pairs: Sequence[ResponseChoice] = (),
    band: tuple[float, float] | None = None,
    overlay: str | os.PathLike[str] | None = None,
    text: str | None = None,
    over_speed: Sequence[str] = (),
    measured: str | os.PathLike[str] | None = None,
) -> Session:
    """Session of the page with a model read from its file, and a measured response to draw with the calculated one.

    Parameters
    ----------
    model : str or path
        A model file or the name of a library model.
    configuration : str
    settings : mapping, optional
        Parameter -> value that the page begins with; ``operating_point.torque.crank`` and so on take the place of
        what the file says, so that the sliders begin there.
    pairs : sequence of ResponseChoice
        Responses to offer; the first one is shown.
    band : (float, float), optional
        Hz; default: what suits the modes of all configurations.
    overlay : str or path, optional
        A file with a measured frequency response.
    text : str, optional
        The model itself, where no file holds it.
    over_speed : sequence of str, optional
        Outputs to offer over the speed of the running machinery; the page begins with the first one.
    measured : str or path, optional
        A file of measured orders, drawn over the calculated ones.

    Raises
    ------
    ModelError
        The model or the test is faulty.
    UsageError
        A name that does not exist, a file that is missing.

    Examples
    --------
    >>> open_session("amt_rig", "V").start.choice
    {'gear': 'V'}
    """
    path = Path("model.yaml") if text is not None else find_model(model)
    folder = path.parent if text is None else None
    text = decode(path.read_bytes(), str(path)) if text is None else text
    base = loads(text, str(path), folder)
    test = None if overlay is None else read_overlay(overlay)
    choice = parse_choice(configuration, base.definition.configurations) if configuration else {}
    values = dict(settings or {})
    point = point_settings(values, base)
    base = base.configured(**point) if point else base
    values = {key: value for key, value in values.items() if key not in point}
    base.configured(configuration, **values)  # refuses what is impossible before a page is opened
    start = opening_state(base, choice, values, pairs, band or _band(base), test, over_speed)
    if over_speed:
        calculated = base.order_response(list(over_speed))  # refuses a name that is none
        if measured is not None:
            _check_orders(measured, calculated)
    elif measured is not None:
        raise UsageError(
            "measured orders are drawn over the speed: say which output they are of with --over-speed",
            kind="missing-entry",
        )
    name = "" if overlay is None else Path(overlay).name
    session = Session(
        str(model), path.name, text, base, start, tuple(pairs), tuple(over_speed), test, name, folder,
        None if measured is None else Path(measured), point,
    )  # fmt: skip
    for pair in pairs:
        asked = session.with_defaults(replace(start, output=pair.output, input=pair.input))
        base.frequency_response(asked.output, asked.input, [1.0], driven_by=asked.excitation or None)
    return session


def opening_state(
    base: Drivetrain,
    choice: Mapping[str, str],
    values: Mapping[str, Any],
    pairs: Sequence[ResponseChoice],
    band: tuple[float, float],
    overlay: FrequencyResponse | None,
    over_speed: Sequence[str],
) -> State:
    """State that a page begins with, where nothing else was asked for the first limited stress or torque over speed."""
    first = pairs[0] if pairs else default_pair(base, overlay)
    start = State(choice, values, first.output, first.input, band=band)
    limited = "" if pairs or overlay else limited_output(base)
    output = over_speed[0] if over_speed else limited
    return replace(start, axis="speed", output=output) if output else start


def _band(base: Drivetrain) -> tuple[float, float]:
    """Frequencies in Hz that suit the modes of all configurations whose operating point is in balance."""
    modes: list[Modes] = []
    lowest = MOST_MODES if len(base.nodes) > MANY_NODES else None
    for name in ("", *base.configurations[:MOST_SURVEYED]):
        with contextlib.suppress(TorsionnetError):  # the page says why, once that configuration is chosen
            modes.append((base.configured(name) if name else base).modes(lowest=lowest))
    return opening_range(*modes) if modes else BAND_WITHOUT_MODES


def _check_orders(path: str | os.PathLike[str], run: OrderResponse) -> None:
    """Refuse a file of orders that has none for the output that is shown at first."""
    from torsionnet.io.tracked_order_tables import read_orders
    from torsionnet.machinery.orders.order_comparison import compared_orders

    compared_orders(run, run.outputs[0].name, read_orders(path, run.outputs[0]))


def read_overlay(path: str | os.PathLike[str]) -> FrequencyResponse:
    from torsionnet.io import read_frequency_response  # loads what most pages do without

    return read_frequency_response(path)
