"""LaTeX of the torque of a law of motion, piece by piece."""

from __future__ import annotations

from typing import Any

import sympy

from torsionnet.model.elements import MotionLaw
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope
from torsionnet.model.motion_laws.smooth_curves import CubicCurve

GAMMA, RATE = sympy.Symbol("gamma"), sympy.Symbol(r"\dot{\gamma}")


def torque_text(law: MotionLaw) -> str | None:
    """LaTeX of the torque of a law of motion of straight pieces or with a cube; None for other curves."""
    curve = law.curve
    if isinstance(curve, CubicCurve):
        return rf"T = {sympy.latex(curve.stiffness * GAMMA + curve.cubic * GAMMA**3)}"
    if not isinstance(curve, PieceCurve):
        return None
    over = GAMMA if curve.over == "twist" else RATE
    before = (None, *curve.pieces)
    rows = [
        f"{_torque(piece)} & {_where(piece, over, last)}" for last, piece in zip(before, curve.pieces, strict=False)
    ]
    return r"T = \begin{cases} " + r" \\ ".join(rows) + r" \end{cases}"


def _torque(piece: Slope | Hold) -> str:
    if isinstance(piece, Hold):
        return rf"{_number(piece.low)} \ldots {_number(piece.high)}"
    text = sympy.latex(sympy.expand(piece.torque + piece.stiffness * GAMMA + piece.damping * RATE))
    if not piece.side:
        return text
    return rf"\{'max' if piece.side > 0 else 'min'}\left(0,\ {text}\right)"


def _where(piece: Slope | Hold, over: sympy.Symbol, before: Slope | Hold | None) -> str:
    """Range of a piece, to which its lower end belongs unless that is a step."""
    at = sympy.latex(over)
    if isinstance(piece, Hold):
        return f"{at} = {_number(piece.at)}"
    below = (
        "" if piece.lower is None else f"{_number(piece.lower)} {'<' if isinstance(before, Hold) else chr(92) + 'le'} "
    )
    above = "" if piece.upper is None else f" < {_number(piece.upper)}"
    return below + at + above


def _number(value: Any) -> str:
    return sympy.latex(sympy.sympify(value))
