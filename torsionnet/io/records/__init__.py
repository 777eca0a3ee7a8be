"""What becomes of a file's channels, whichever format it is in: a recording, whole or in blocks."""
