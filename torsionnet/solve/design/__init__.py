"""Design of dampers for the smallest maximum of a vibration."""

from torsionnet.solve.design.damper_design import damper_design

__all__ = ["damper_design"]
