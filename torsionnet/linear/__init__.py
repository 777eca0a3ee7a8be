"""Linear vibration of drivetrains: rows, frequency responses, modes, sensitivities, variants and their results."""
