"""What the report on a model is to hold, as the ``report:`` section of its file says."""

from torsionnet.outline.outline import Outline, Pair, parse_band
from torsionnet.outline.sections import SECTIONS

__all__ = ["SECTIONS", "Outline", "Pair", "parse_band"]
