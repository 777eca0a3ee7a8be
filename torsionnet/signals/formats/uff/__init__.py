"""Universal files, which hold recordings and frequency responses as datasets 58."""
