"""What an author wrote, as data: elements, parameters, sensors, configurations, checks, model files."""
