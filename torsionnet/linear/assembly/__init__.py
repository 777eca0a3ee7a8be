"""Assembly of a drivetrain into rows, matrices and readings of sensors, in numbers and in symbols."""
