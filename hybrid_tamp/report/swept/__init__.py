"""The picture of the swept paths of a plan: views to scale, with the closest pair of each movement."""
