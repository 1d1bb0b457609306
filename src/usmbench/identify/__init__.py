"""From measured runs to a model."""
