"""Verdicts on limits over speed, ranges of speed to be barred, and operating instructions."""
