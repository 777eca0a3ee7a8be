"""Parts of models, which are models with ports that others use as often as they need them."""
