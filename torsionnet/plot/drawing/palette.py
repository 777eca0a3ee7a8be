"""Colours of all pictures, as hexadecimal codes."""

from __future__ import annotations

# Okabe and Ito's colours without the yellow, which is lost on white: told apart with any kind of colour vision.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#444444", "#56B4E9", "#E69F00")
INK, MUTED, FAINT, PAPER = "#222222", "#6b6b6b", "#dddddd", "#ffffff"
