"""Complex orders of recorded signals: tracking, phase references, their scatter."""
