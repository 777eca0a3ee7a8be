"""``make types``: what pyright and mypy --strict say of programs that use the package, right ones and wrong ones."""
