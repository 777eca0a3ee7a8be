"""State of the explore page as a command line that prints the same numbers."""

from __future__ import annotations

import os
import shlex
import subprocess
from typing import TYPE_CHECKING

from torsionnet.app.explore.state import State
from torsionnet.model.configurations import label

if TYPE_CHECKING:
    from torsionnet.app.explore.session import Session


def command_text(session: Session, state: State) -> str:
    """Command line ``torsionnet frf MODEL ...``, or ``orders``, for a state of the page, quoted for the shell here.

    Examples
    --------
    >>> from torsionnet.app.explore import open_session
    >>> rig = open_session("amt_rig")
    >>> print(command_text(rig, rig.with_defaults(State({"gear": "V"}, {"c_O": 360}, band=(1.0, 50.0)))))
    torsionnet frf amt_rig -c V --set c_O=360 --output theta_1 --input T_M --from 1 --to 50
    """
    words = ["torsionnet", "orders" if state.axis == "speed" else "frf", session.model]
    if state.choice:
        words += ["-c", label(dict(state.choice), session.base.definition.configurations)]
    for name, value in state.values.items():
        words += ["--set", f"{name}={value}"]
    words += ["--output", state.output, *([] if state.axis == "speed" else _of_response(session, state))]
    if state.axis == "speed" and session.measured is not None:
        words += ["--measured", str(session.measured)]
    if state.angle != "rad":
        words += ["--angle", state.angle]
    words += ["--db"] * (state.decibels and state.axis == "frequency")
    return subprocess.list2cmdline(words) if os.name == "nt" else shlex.join(words)


def _of_response(session: Session, state: State) -> list[str]:
    """Options of ``torsionnet frf`` for the input, the band and the form of a response."""
    words = ["--input", state.input]
    if state.excitation and len(session.base.inputs) != 1:
        words += ["--excitation", state.excitation]
    if any(state.band):
        words += ["--from", f"{state.band[0]:g}", "--to", f"{state.band[1]:g}"]
    if state.quantity:
        words += ["--quantity", state.quantity]
    return words
