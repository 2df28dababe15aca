"""Which object affords which block, and to whom (paper, Sec. II-E)."""
