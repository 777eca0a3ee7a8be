"""What a change has to pass, in phases: all of ``.ci/run``, and the parts of the night."""
