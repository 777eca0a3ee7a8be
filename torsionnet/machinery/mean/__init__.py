"""Mean torques and speeds of a running machine, its power balance and losses."""
