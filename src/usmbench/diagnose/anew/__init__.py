"""Models identified under the very cause that they should show."""
