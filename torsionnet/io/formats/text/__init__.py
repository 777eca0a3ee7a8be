"""Tables of numbers as text: records in many dialects, responses as CSV."""
