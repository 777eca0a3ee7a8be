"""Export of drivetrains as functional mock-up units (FMI 2.0 and 3.0) of generated C."""

from torsionnet.io.fmu.archive import write_fmu

__all__ = ["write_fmu"]
