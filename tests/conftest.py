"""For all tests: what pytest's search for doctests leaves out."""

# The plugin of `make mutation` reads its settings from the run that loads it.
collect_ignore = ["mutation/plugin.py"]
