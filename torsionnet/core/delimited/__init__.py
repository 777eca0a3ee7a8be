"""Text files with columns of numbers: how they separate and write them, what is above them, and where one is wrong."""
