"""Recordings from the channels of a file, whichever format it is in, as a whole or in blocks."""
