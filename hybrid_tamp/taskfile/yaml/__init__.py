"""Read YAML 1.2 with the line and column of every node, and write YAML 1.2."""
