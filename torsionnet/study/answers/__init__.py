"""What is concluded from a study, each kind in a file of its own that is imported where the kind is asked for."""
