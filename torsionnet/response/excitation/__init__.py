"""Results on what excites a drivetrain, harmonics of a cylinder, orders at one speed and vector sums."""
