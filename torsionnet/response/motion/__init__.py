"""Events and energies of motion over time."""
