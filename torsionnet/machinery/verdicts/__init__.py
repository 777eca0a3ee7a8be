"""Verdicts of limits on a machine, with ranges barred to operation, margins and instructions."""
