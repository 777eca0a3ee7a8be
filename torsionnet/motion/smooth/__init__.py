"""Motion over time with laws that do not follow straight pieces, by Runge-Kutta methods between events."""
