"""How the package is built: what imports what, and a few counts that should go down. ``make structure`` prints them."""
