"""Plan and bench files: reading, checking, and errors that name the line."""
