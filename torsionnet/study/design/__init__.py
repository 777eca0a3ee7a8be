"""Optimum designs of a drivetrain for targets, objectives and limits, Pareto fronts, robust designs under tolerances."""
