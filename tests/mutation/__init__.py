"""Would a test notice? Small faults are put into a copy of the package, one at a time, and its tests run.

``make mutation ARGS="-n 120 torsionnet/modal"``. Own code on `ast`, because cosmic-ray (8.7) edits the checkout in
place, has one test command for a session and no seeded sample, and mutmut (3.8) chooses the tests from a run of the
whole suite and has no sample either; neither knows `abs`, `.conj()`, `.T`, min and max.
"""
