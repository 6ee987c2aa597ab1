"""Grids of plies and diaphragms, and the tool: its surface and distance field."""
