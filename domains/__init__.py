"""Domains that come with hybrid_tamp: content, not framework. Each folder reads as one story."""
