"""Mass-elastic sheets of makers, tables of text with inertias and the shafts between them."""
