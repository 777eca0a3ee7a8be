"""Recorded and simulated signals: records, processing, and the frequency responses estimated from them."""
