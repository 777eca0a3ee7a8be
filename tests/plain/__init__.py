"""Random plants of components, beside equations written down from what is documented of each component.

``components`` draws an element as the entries of a model file and says by which laws and conditions it acts, out of its
documentation alone; ``trains`` joins them, puts some into parts, and imposes torques and motions between nodes;
``equations`` solves all node angles and all conditions at once, in hundreds of digits; ``campaign`` compares. Run
``python -m plain --models 300`` in the folder ``tests``.
"""
