"""Runs cut into stretches in which every row is comparable."""
