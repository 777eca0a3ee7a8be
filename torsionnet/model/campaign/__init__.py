"""Entries of a campaign file: records of a rotating test with their conditions, wheels, channels, what is wanted."""
