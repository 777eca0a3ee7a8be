"""Many variants of one drivetrain solved together, from arrays of parameters to arrays of responses and modes."""
