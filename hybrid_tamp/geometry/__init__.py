"""Shapes, hulls, meshes and surfaces of bodies. This package does not depend on tokens or tasks."""
