"""Models and results of other programs, in and out. Each function reads or writes whole files or returns text."""

from torsionnet.interchange.responses.files import read_frequency_response, write_frequency_response

__all__ = ["read_frequency_response", "write_frequency_response"]
