"""Shapes, hulls, meshes and surfaces: bodies in their own frames, without tokens or tasks."""
