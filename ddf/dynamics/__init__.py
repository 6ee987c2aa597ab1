"""Time: the step, its stable length, the team of threads."""
