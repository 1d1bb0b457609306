"""The usmbench command."""
