"""Model of a drivetrain as data: elements, parameters, sensors, configurations, checks, model files."""
