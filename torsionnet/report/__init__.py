"""Pictures of drivetrains and results. Each function returns a matplotlib figure and shows or writes nothing."""

from torsionnet.report.bode import bode
from torsionnet.report.save import save
from torsionnet.report.schematic import schematic
from torsionnet.report.shapes import mode_shapes

__all__ = ["bode", "mode_shapes", "save", "schematic"]
