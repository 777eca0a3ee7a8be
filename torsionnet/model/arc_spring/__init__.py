"""Arc springs that rub in a curved channel: their slow loops in closed form, and as a chain of segments."""
