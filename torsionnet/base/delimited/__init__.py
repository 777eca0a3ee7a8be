"""Reading of text files with columns of numbers: separators, decimal signs, headings, units, time stamps, faults."""
