"""The domains that hybrid_tamp includes, one per folder."""
