"""A stand-in for the NI gRPC device server, with one simulated card behind it."""

from hil_sim.ni_server.server import NiServer

__all__ = ["NiServer"]
