"""Diagrams of knots and links, and what can be computed from them; nothing here knows of mechanics."""
