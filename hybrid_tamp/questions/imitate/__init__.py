"""Which blocks were seen to run, and how another agent does likewise (paper, Sec. II-E)."""
