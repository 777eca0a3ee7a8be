"""Picture of periodic motions: what is unstable is dashed however close the motions lie, doubled branches join on."""

from __future__ import annotations

import numpy as np

import torsionnet as tn
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse


def _motion(at: float, swing: float, stability: str, branch: int = 0, periods: int = 1, turn: str = "") -> FoundMotion:
    low, high = np.array([-swing / 2]), np.array([swing / 2])
    return FoundMotion(
        at, branch, turn, periods, 9, 0.0, low, high, np.zeros((2, 1), dtype=complex), np.zeros(0, dtype=complex),
        stability,
    )  # fmt: skip


def _response() -> PeriodicResponse:
    """Branch that is unstable from 20 to 30 Hz in small steps, and one of doubled motions that begins at 20 Hz."""
    steps = np.linspace(20.1, 29.9, 200)
    single = [
        _motion(10, 1.0, "stable"),
        _motion(20, 1.0, "on the edge: doubling", turn="doubling"),
        *(_motion(float(at), 1.0, "unstable: doubles") for at in steps),
        _motion(30, 1.0, "on the edge: doubling", turn="doubling"),
        _motion(40, 1.0, "stable"),
    ]
    # nearer to where it ends than to where it begins
    doubled = [_motion(float(at), 1.5, "stable", 1, 2) for at in (27.0, 28.0, steps[-1])]
    channel = tn.Channel("twist", "rad")
    return PeriodicResponse(
        "frequency", "", 1.0, (channel,), (*single, *doubled), ("from rest", "doubled at 20 Hz"), "rig"
    )


def test_dashes_are_seen_where_motions_lie_close():
    (axes,) = tn.plot.periodic_response(_response()).axes
    (dashed,) = [line for line in axes.lines if line.get_linestyle() == "--"]
    assert (dashed.get_xdata()[0], dashed.get_xdata()[-1]) == (20, 30)
    solid = [line.get_xdata() for line in axes.lines if line.get_linestyle() == "-"]
    assert [[float(x[0]), float(x[-1])] for x in solid] == [[10, 20], [30, 40], [20, 30]]


def test_doubled_branch_begins_and_ends_at_its_doublings():
    (axes,) = tn.plot.periodic_response(_response()).axes
    branch = [line for line in axes.lines if str(line.get_label()).startswith("branch 2")]
    assert [float(x) for x in branch[0].get_xdata()] == [20, 27, 28, 29.9, 30]
    assert float(branch[0].get_ydata()[0]) == 1.0
