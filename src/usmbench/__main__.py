"""`python -m usmbench` is the usmbench command."""

from usmbench.cli.main import entry_point

if __name__ == "__main__":
    entry_point()
