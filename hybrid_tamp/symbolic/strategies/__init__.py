"""Planning strategies, which plan goals separately and rebind tokens. The law checker judges every result."""
