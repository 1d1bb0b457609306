"""Bench stack for travelling-wave ultrasonic motors: drive, measure, identify, diagnose."""

__version__ = "0.1.0"
