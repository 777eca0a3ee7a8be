"""The schematic of a drivetrain: stations, shaft lines, emblems, wiring."""
