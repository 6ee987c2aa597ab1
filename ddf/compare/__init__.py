"""Two finished runs, and a measured outline, against each other."""
