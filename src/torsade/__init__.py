"""Geometry, topology and mechanics of twisted elastic fibers."""

__version__ = "0.1.0"
