"""Running machinery: motion over time, orders over speed, critical speeds, limits."""
