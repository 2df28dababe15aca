"""Task files that come with hybrid_tamp."""
