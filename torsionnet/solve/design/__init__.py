"""Dampers that make the largest vibration smallest."""

from torsionnet.solve.design.damper_design import damper_design

__all__ = ["damper_design"]
