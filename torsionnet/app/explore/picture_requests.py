"""Answers of the explore page for its schematic and for the motion of its modes, as JSON data."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from torsionnet.app.explore.answers import MANY_NODES, collected_notes, fault_texts, page_modes
from torsionnet.app.explore.mode_motion import mode_motion
from torsionnet.app.explore.session import Session
from torsionnet.app.explore.state import State
from torsionnet.base.errors import TorsionnetError

Make: TypeAlias = Callable[[Session, State], dict[str, Any]]
MOST_MOVING = 12
"""Number of lowest modes of a large model that the page can move; each more takes time while the text is written."""
BYTES_OF_MOTION = 100
"""Size in bytes of the motion of one node in one mode, roughly."""


def schematic_answer(session: Session, state: State) -> dict[str, Any]:
    """Schematic of a state's drivetrain as SVG text, with the ids of elements and nodes, as JSON data.

    It shows the elements of the configuration chosen and the values of the sliders; reasons under ``refused`` if the
    state is impossible.

    Examples
    --------
    >>> from torsionnet.app.explore.session import open_session
    >>> schematic_answer(open_session("amt_rig"), State({"gear": "V"}))["elements"]["gearbox"]
    'element-gearbox'
    """
    return _kept(session, state, "schematic", _schematic)


def motion_answer(session: Session, state: State) -> dict[str, Any]:
    """Motion of the nodes in each mode of a state's drivetrain, and mean torques of its elements, as JSON data.

    Reasons under ``refused`` if the state is impossible.
    """
    return _kept(session, state, "motion", _mode_motion)


def _schematic(session: Session, state: State) -> dict[str, Any]:
    from torsionnet.plot.schematics.svg_drawing import schematic_svg  # what draws is loaded by pages that show it

    drawing = schematic_svg(session.model_for(state))
    return {
        "svg": drawing.svg,
        "elements": dict(drawing.elements),
        "nodes": dict(drawing.nodes),
        "size": list(drawing.size),
    }


def _mode_motion(session: Session, state: State) -> dict[str, Any]:
    rig = session.model_for(state)
    with collected_notes() as notes:
        is_large = len(rig.nodes) > MANY_NODES
        found = mode_motion(rig, rig.modes(lowest=MOST_MOVING) if is_large else page_modes(rig))
    said = [f"{len(rig.nodes)} nodes: the {MOST_MOVING} lowest modes can be moved"] if is_large else []
    return found | {"notes": list(dict.fromkeys([*said, *found["notes"], *notes]))}


def _kept(session: Session, state: State, what: str, make: Make) -> dict[str, Any]:
    """Answer that depends on the configuration and the values of a state alone, kept by the session."""
    key = (what, tuple(state.choice.items()), tuple(state.values.items()))

    def answer() -> dict[str, Any]:
        try:
            return dict(make(session, state))
        except TorsionnetError as error:
            return {"refused": fault_texts(error)}

    return session.pictures.once(dict, key, answer, _size)


def _size(found: dict[str, Any]) -> int:
    moved = sum(len(mode["nodes"]) for mode in found.get("modes", ()))
    return len(found.get("svg", "")) + BYTES_OF_MOTION * moved
