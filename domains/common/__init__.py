"""What several domains share, written once: hands, regions, REACHING and RESTING."""
