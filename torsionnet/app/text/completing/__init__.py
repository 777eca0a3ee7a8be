"""Options for what is written at a place of a model text: keys, values, names, units, from the entries."""
