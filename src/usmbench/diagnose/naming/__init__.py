"""Which causes to name, and whether the names may stand."""
