"""Text, tables, pictures and documents of results, for people and programs."""
