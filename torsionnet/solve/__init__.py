"""Frequency responses, modes and state space from an assembled drivetrain."""
