"""Mass-elastic sheets of makers: inertias and the shafts between them in a table of text."""
