"""Space of the variants of a study, with distributions, lists and ranges of parameters, sampling and correlation."""
