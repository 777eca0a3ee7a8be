"""Motion over time of drivetrains with laws of motion: contacts, stages and friction."""
