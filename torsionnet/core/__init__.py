"""What everything rests on: errors, units, expressions, files written as a whole. Nothing here knows a drivetrain."""
