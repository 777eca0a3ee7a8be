"""Optimum designs of a drivetrain, for targets, objectives and limits, Pareto fronts, and robustly under tolerances."""
