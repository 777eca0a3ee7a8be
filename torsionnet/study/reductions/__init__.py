"""Statistics of values that come in chunks of variants, as moments, histograms, counts beyond limits, kept values."""
