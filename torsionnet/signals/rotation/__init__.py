"""Rotation of shafts from the pulses of toothed wheels and encoders, and the errors of their pitches."""
