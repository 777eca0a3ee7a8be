"""Optimum designs: parameters for targets, objectives and limits, Pareto fronts, robust designs under tolerances."""
