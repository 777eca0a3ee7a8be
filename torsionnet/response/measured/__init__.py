"""Results of tests on turning machinery: pulse times of wheels, pitch patterns, tracked orders."""
