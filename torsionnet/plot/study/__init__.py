"""Pictures of the answers of studies."""
