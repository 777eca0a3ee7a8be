"""Batches of variants of one drivetrain: arrays of parameters in, arrays of coefficients, responses and modes out."""
