"""How the values of variants are drawn: sequences, correlations, joint distributions."""
