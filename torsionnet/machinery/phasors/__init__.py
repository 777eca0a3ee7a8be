"""Excitation as complex amplitudes by order: lines, vector sums, star diagrams, generalised forces."""
