"""Many variants of one drivetrain at once: arrays of parameters in, arrays of coefficients, responses and modes out."""
