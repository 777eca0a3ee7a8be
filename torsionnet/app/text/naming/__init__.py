"""Names in the entries of a model, what they stand for, and their stretches of its text."""
