"""Universal files: records and frequency responses as datasets 58."""
