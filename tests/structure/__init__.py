"""Structure of the package: imports between modules, and counts that should go down, printed by ``make structure``."""
