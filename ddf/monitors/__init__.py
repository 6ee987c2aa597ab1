"""Observers: energies, guards, audit."""
