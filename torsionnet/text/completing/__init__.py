"""Options that may follow at a place of a model text, keys, values, names and units, from the specifications of entries."""
