"""From a drivetrain to rows, matrices and sensor functionals, in numbers and in symbols."""
