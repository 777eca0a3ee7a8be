"""Models and results of other programs, in and out. Each function reads or writes whole files or returns text."""

from torsionnet.interchange.fmu import write_fmu
from torsionnet.interchange.matlab import to_matlab, write_matlab
from torsionnet.interchange.modelica import to_modelica, write_modelica
from torsionnet.interchange.responses.files import read_frequency_response, write_frequency_response
from torsionnet.interchange.tors_reading import from_tors, read_tors
from torsionnet.interchange.tors_writing import to_tors, write_tors

__all__ = [
    "from_tors",
    "read_frequency_response",
    "read_tors",
    "to_matlab",
    "to_modelica",
    "to_tors",
    "write_fmu",
    "write_frequency_response",
    "write_matlab",
    "write_modelica",
    "write_tors",
]
