"""Broken input of every kind: whatever is in a file, a result or an error with its place, soon and in little memory."""
