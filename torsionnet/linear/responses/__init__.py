"""Frequency responses between inputs and sensors of a drivetrain, with their peaks and stability margins."""
