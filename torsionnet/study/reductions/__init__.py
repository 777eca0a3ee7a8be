"""What is kept of values that come in chunks: sums that can be put together in a fixed order."""
