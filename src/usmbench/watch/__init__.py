"""The live page of a run: rows as they are appended, a bounded view of them, a local server."""
