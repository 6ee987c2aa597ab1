"""Sweeps: one case under many changes, run by local processes, resumable, into one table and comparing pictures."""
