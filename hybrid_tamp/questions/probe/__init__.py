"""Of which classes a token never seen before is a member (paper, Sec. II-B)."""
