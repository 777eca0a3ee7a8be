"""Parameters that meet targets, make something smallest, or are the best compromise; under tolerances, too."""
