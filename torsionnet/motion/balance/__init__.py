"""Steady balance of a drivetrain with laws of motion: mean speeds, torques and twists of its operating point."""
