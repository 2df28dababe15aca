"""Pictures of a recording: camera, appearance of tokens and renderer."""
