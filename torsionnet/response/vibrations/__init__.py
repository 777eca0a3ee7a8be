"""Results on vibrations, modes with their frequencies in Hz, nodes at rest, and cycles over time."""
