"""Results on what excites a drivetrain: harmonics of engines, vector sums of cylinders, torques by order."""
