"""Physical causes by which a simulation is extended, one file a cause."""
