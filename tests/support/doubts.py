"""Points at which an elimination to seven digits differs."""

import numpy as np

from torsionnet.linear.dynamic_stiffness.quotient import rounding_errors, uncertain_points


def in_doubt(respond, problem, kappa):
    """Mask (n_points,) of points at which motions and reactions by ``respond`` lose digits."""

    def evaluate(laws, _):
        return np.moveaxis(respond(problem, laws), 2, 0)

    return uncertain_points(rounding_errors(evaluate, kappa, evaluate(kappa, False)), 1)
