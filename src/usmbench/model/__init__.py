"""The simulation: a Hammerstein system, and the file it is kept in."""
