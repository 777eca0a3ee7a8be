"""Marks of inputs and sensors on a shaft line, with their names above the shaft."""

from __future__ import annotations

from dataclasses import dataclass

from torsionnet.plot.drawing.pieces import Piece, Stroke, Texts
from torsionnet.plot.schematics import outlines
from torsionnet.plot.schematics.texts import break_lines

TOPS = {"input": 19.0, "reaction": 19.0, "motion": 20.0, "torque": 20.0}
"""Heights in points above the shaft at which the name of a mark begins, by kind of mark."""

ARROW = 17.0
"""Half the height of a torque arrow in points."""


@dataclass(frozen=True)
class Mark:
    """Mark in a schematic of an input, of its reaction on a second node, or of a sensor of motion or torque."""

    kind: str
    name: str
    """Text of the name, set as a symbol if it is one."""
    what: str
    channel: str
    """Name of the input or sensor in the model."""

    def piece(self, lift: float = 0.0) -> Piece:
        """Drawing of the mark around x = 0, with its name raised by ``lift`` points above the usual height."""
        top = TOPS[self.kind] + lift
        piece = Piece()
        with piece.owned("input" if self._is_arrow else "sensor", self.channel):
            self._draw(piece, top, lift)
        return piece

    def _draw(self, piece: Piece, top: float, lift: float) -> None:
        if self._is_arrow:
            piece.strokes += outlines.torque_arrow(0.0, opposite=self.kind == "reaction")
            piece.boxes.append((-8, 8, -ARROW - 2, TOPS["input"]))
        else:
            piece.strokes += outlines.sensor_mark(0.0, torque=self.kind == "torque", leader=top)
            piece.boxes.append((-5, 5, -5, TOPS["torque"]))
        if lift:
            leader = Stroke(((0, ARROW), (0, top)), "leader")
            piece.strokes += [leader] if self._is_arrow else []
            piece.boxes.append((-1.5, 1.5, 0, top))
        piece.write(0, top, self.texts)

    @property
    def _is_arrow(self) -> bool:
        return self.kind in ("input", "reaction")

    @property
    def texts(self) -> Texts:
        """Lines (text, role) of the label of the mark, its name and its description."""
        return break_lines([(self.name, "input" if self._is_arrow else "sensor"), (self.what, "what")])
