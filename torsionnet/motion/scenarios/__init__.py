"""Scenarios of a model over time, such as torques and short circuits, one kind in each file of this package."""

from torsionnet.motion.scenarios.scenario import SCENARIOS, DrivingCourse, Scenario, scenario_kinds

__all__ = ["SCENARIOS", "DrivingCourse", "Scenario", "scenario_kinds"]
