"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.report.bode import bode
from torsionnet.report.circle import circle
from torsionnet.report.mac import mac_matrix
from torsionnet.report.save import save
from torsionnet.report.schematic import schematic
from torsionnet.report.shapes import mode_shapes
from torsionnet.report.stabilisation import stabilisation

__all__ = ["bode", "circle", "mac_matrix", "mode_shapes", "save", "schematic", "stabilisation"]
