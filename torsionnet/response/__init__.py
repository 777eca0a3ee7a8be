"""Results: frequency responses, modes, tables, and the conventions in which they are shown."""

from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.family import FrequencyResponses
from torsionnet.response.frequency_response import Channel, FrequencyResponse
from torsionnet.response.modes import Modes
from torsionnet.response.table import Column, Table

__all__ = ["SI", "Channel", "Column", "Conventions", "FrequencyResponse", "FrequencyResponses", "Modes", "Table"]
