"""Style, sizes, shapes and files that all pictures have in common."""
