"""Curves of torque over twist and rate of which elements make their laws of motion."""
