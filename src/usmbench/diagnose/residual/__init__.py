"""The residual, whitened given all that is known, and its views."""
