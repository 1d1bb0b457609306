"""A motor that several campaigns' cases share."""

from small_motor_bench import motor_bench

__all__ = ["motor_bench"]
