"""Who drives a drivetrain, who absorbs its power, and the mean torques that follow."""
