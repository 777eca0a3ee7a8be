"""Recordings from the channels of a file, whichever format it is in: whole or in blocks."""
