"""Codes of dataset 58 (SDRC universal file format, `<https://www.ceas3.uc.edu/sdrluff/>`_)."""

GENERAL_FUNCTION, FRF, TRANSMISSIBILITY, COHERENCE = 0, 4, 5, 6
"""Record 6, field 1."""
ROTATION = 4
"""Record 6, fields 7 and 10: rotation about +X; negative about -X, 5 and 6 about Y and Z."""
TRANSLATIONS = frozenset({1, 2, 3})
WIDTH = 80
"""Characters of an ID line."""
BETWEEN = " / "

TYPES = {"rad": 8, "rad/s": 11, "rad/s^2": 12, "N*m": 13}
"""Records 9 and 10, field 1: displacement, velocity, acceleration, excitation force, of a rotation."""
UNITS = {code: unit for unit, code in TYPES.items()} | {9: "N*m"}
"""The SI unit behind a code where the file gives no label; 9 is a reaction."""
