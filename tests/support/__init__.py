"""What several files of tests use: plants, records, pages, comparisons, and what a run of tests does."""
