"""Loops of torque over twist of a slow test: cycles, branches, stages, friction, loss."""
