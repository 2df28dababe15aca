"""Pictures of recordings: the camera, the appearance of tokens and the renderer."""
