"""Sessions of the explore page made anew from a text, with what its command line asked for where that still fits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from torsionnet.app.explore.choices import ResponseChoice, default_pair
from torsionnet.app.explore.over_speed import runs
from torsionnet.app.explore.point_sliders import point_settings
from torsionnet.app.explore.session import Session
from torsionnet.app.explore.state import State
from torsionnet.base.errors import TorsionnetError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.model.configurations import parse_choice


@dataclass(frozen=True)
class SessionOptions:
    """Options of the command line that began the page, beside the model.

    Attributes
    ----------
    model : str
        Name or path on the command line, for commands that the page shows.
    path : Path
        Of the model file; it need not exist.
    folder : Path, optional
        Where files that the text names lie; None: it can name none.
    configuration : str
    settings : mapping
        Parameter -> value.
    pairs : tuple of ResponseChoice
    band : (float, float), optional
        Hz; default: what suits the modes, anew for each text.
    overlay : FrequencyResponse, optional
    overlay_name : str
    over_speed : tuple of str
    measured : Path, optional
        A file of measured orders.
    opened : Session, optional
        As the page was opened; the same text begins in the same state.
    """

    model: str
    path: Path
    folder: Path | None = None
    configuration: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    pairs: tuple[ResponseChoice, ...] = ()
    band: tuple[float, float] | None = None
    overlay: FrequencyResponse | None = None
    overlay_name: str = ""
    over_speed: tuple[str, ...] = ()
    measured: Path | None = None
    opened: Session | None = None

    @classmethod
    def of(cls, session: Session) -> SessionOptions:
        """Options with which a session was opened, as far as it shows them."""
        choice = ",".join(f"{axis}={alternative}" for axis, alternative in session.start.choice.items())
        folder = session.folder
        return cls(
            session.model, Path(session.file) if folder is None else folder / session.file, folder, choice,
            {**session.point, **session.start.values}, session.pairs, session.start.band, session.overlay,
            session.overlay_name, session.over_speed, session.measured, session,
        )  # fmt: skip


def remade_session(base: Drivetrain, text: str, options: SessionOptions) -> Session:
    """Session of a sound text; options that do not fit this model are left out without a word."""
    point, base = _operating_point(base, options.settings)
    choice = _choice(base, options.configuration)
    values = _values(base, choice, {name: value for name, value in options.settings.items() if name not in point})
    pairs = tuple(pair for pair in options.pairs if _is_known(base, pair))
    first = pairs[0] if pairs else default_pair(base, options.overlay)
    start = State(choice, values, first.output, first.input, band=options.band or (0.0, 0.0))
    over_speed = options.over_speed if runs(base) else ()
    if over_speed:
        start = replace(start, axis="speed", output=over_speed[0])
    if options.opened is not None and options.opened.text == text:
        start = options.opened.start
    return Session(
        options.model, options.path.name, text, base, start, pairs, over_speed, options.overlay, options.overlay_name,
        options.folder, options.measured if over_speed else None, point,
    )  # fmt: skip


def _operating_point(base: Drivetrain, settings: Mapping[str, Any]) -> tuple[dict[str, Any], Drivetrain]:
    """Operating point that settings give, and the drivetrain in it."""
    try:
        point = dict(point_settings(settings, base))
        return point, base.configured(**point) if point else base
    except TorsionnetError:
        return {}, base


def _choice(base: Drivetrain, configuration: str) -> dict[str, str]:
    try:
        return dict(parse_choice(configuration, base.definition.configurations)) if configuration else {}
    except TorsionnetError:
        return {}


def _values(base: Drivetrain, choice: Mapping[str, str], values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of parameters that the model has and takes, each beside those before it."""
    name = ",".join(f"{axis}={alternative}" for axis, alternative in choice.items())
    kept: dict[str, Any] = {}
    for parameter, value in values.items():
        try:
            base.configured(name, **kept, **{parameter: value})
        except TorsionnetError:
            continue
        kept[parameter] = value
    return kept


def _is_known(base: Drivetrain, pair: ResponseChoice) -> bool:
    """Whether a response can be asked for; torques in elements as ``torque(shaft)`` are tried when they are shown."""
    outputs, inputs = {*base.sensors, *base.nodes}, {*base.inputs, *base.sensors, *base.nodes}
    return all("(" in name or name in known for name, known in ((pair.output, outputs), (pair.input, inputs)))
