"""What varies in a study, and variant number i: distributions, lists and ranges, how they are drawn and correlated."""
