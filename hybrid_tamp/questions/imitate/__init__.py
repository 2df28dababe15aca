"""Imitation: segmentation of a demonstration into blocks, and transfer to another agent (paper, Sec. II-E)."""
