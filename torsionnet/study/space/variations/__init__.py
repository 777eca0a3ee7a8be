"""How a parameter varies: distributions, lists and ranges, each by the word in ``type:``."""
