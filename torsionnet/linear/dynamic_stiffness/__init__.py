"""Solvers for torsional responses from the dynamic stiffness, by elimination on the graph, dense matrices or states."""
