"""Assembly of a drivetrain into rows, matrices and sensor functionals, in numbers and in symbols."""
