"""The noise of a free-running residual, and the windows that are no part of it."""
