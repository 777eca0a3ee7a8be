"""Results on vibrations: natural frequencies counted from 1, and their nodes."""
