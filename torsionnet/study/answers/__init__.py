"""Answers of a study, such as yield, worst case and sensitivities, one file for each kind, imported when it is used."""
