"""What a model may leave without anything being wrong."""
