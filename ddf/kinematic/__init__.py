"""Kinematic draping: a ply as a net of inextensible yarns, pinned where they cross, laid on the tool."""
