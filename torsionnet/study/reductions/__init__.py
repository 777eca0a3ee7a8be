"""Statistics of values that come in chunks: moments, histograms, counts beyond limits, kept values."""
