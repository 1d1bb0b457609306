"""Simulated USR60 testbed: pure machines, with a pty and an NI device server at the edge."""
