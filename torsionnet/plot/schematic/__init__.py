"""Schematic drawing of a drivetrain: shaft lines, symbols of elements, branches and connecting wires."""
