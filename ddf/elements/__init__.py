"""Internal forces: each file one element, with its energy."""
