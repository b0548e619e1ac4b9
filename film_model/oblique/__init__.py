"""Oblique impact: friction, tangential stiffness and spin beside a normal motion that they do not change."""
