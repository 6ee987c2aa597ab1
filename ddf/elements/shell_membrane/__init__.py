"""Superimposed reduced-integration quadrilaterals on shared nodes: a membrane and a shear-deformable shell."""
