"""Parts of models: models with ports, written once and put into others as often as they are needed."""
