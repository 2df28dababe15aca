"""Pictures of a recording: camera, appearance of tokens, and whatever can draw."""
