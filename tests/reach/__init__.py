"""Which functions of the package does each test call? One recorded run says so to several tools.

``make reach`` runs all tests and writes the map. `make test-changed` runs the tests that reach a change, `make mutation` those that reach a
small fault, and the tests with another kernel of BLAS leave out the files that pass no numerical room. Own code, because
coverage.py (7.10) with a context for each test doubles the time of a run, and pytest-testmon (2.1) does not see processes that tests start.
"""
