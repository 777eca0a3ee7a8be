"""What a study asks of every variant, each kind in a file of its own that is imported where the kind is asked for."""
