"""Words on the names, keys and values of a model text."""
