"""Style, units, bars, text sizes and file output that all pictures have in common."""
