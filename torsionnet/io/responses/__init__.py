"""What files of frequency responses have in common, whichever format they are in."""
