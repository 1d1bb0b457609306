"""Effects fitted to a residual, how sure their values are, and what they gain."""
