"""The PyBullet backend. Only this package imports pybullet."""
