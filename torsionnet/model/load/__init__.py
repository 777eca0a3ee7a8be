"""Load of a drivetrain, who drives, who absorbs the power, and the mean torques that follow."""
