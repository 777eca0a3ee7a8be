"""Scripts that measure times: ``python -m benchmarks.modes`` from the root of the checkout.

Run as modules, so that this folder is not on the path and no script's name hides a package.
"""
