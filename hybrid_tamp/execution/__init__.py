"""A plan and a physics backend go in, a `Recording` of what really happened comes out."""
