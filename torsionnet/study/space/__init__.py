"""Space of the variants of a study: distributions, lists and ranges of parameters, their sampling and correlation."""
