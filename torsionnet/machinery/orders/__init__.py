"""Responses by order and speed, calculated and measured, and what they add up to in a cycle."""
