"""Commands of the command line; ``FILES`` of the program says in which file each stands."""
