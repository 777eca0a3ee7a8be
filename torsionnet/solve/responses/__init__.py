"""Frequency responses between inputs and sensors, over frequencies and for many inputs."""
