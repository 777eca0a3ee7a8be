"""Vibration of running machinery, as motion over time, orders over speed, critical speeds and limits."""
