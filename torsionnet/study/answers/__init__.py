"""Answers of a study: yield, worst case, sensitivities and so on, one file for each kind, imported when it is used."""
