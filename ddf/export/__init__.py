"""What is taken from a finished run to the next program: fibres on the tool, flat patterns, an animation."""
