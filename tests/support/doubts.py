"""Points at which an elimination does not agree with one in another order."""

import numpy as np

from torsionnet.linear.dynamic_stiffness.quotient import uncertain_points


def in_doubt(respond, problem, kappa):
    """Mask (n_points,) of points at which motions and reactions by ``respond`` lose digits."""

    def evaluate(laws, other_order):
        return np.moveaxis(respond(problem.in_other_order if other_order else problem, laws), 2, 0)

    return uncertain_points(evaluate, kappa, evaluate(kappa, False))
