"""Schematic drawing of a drivetrain, with its layout, symbols, wires that close loops, and labels."""
