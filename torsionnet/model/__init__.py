"""Model of a drivetrain as data, its elements, parameters, sensors, configurations, checks and files."""
