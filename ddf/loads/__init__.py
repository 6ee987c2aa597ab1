"""The load path."""
