"""Quick fixes: edits of a model text that mend one of its faults each."""
