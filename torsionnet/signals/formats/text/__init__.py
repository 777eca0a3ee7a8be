"""Tables of numbers as text, with recordings in many dialects, and frequency responses as CSV."""
