"""Physics backends, which simulate the tokens.

`protocol` defines the interface of a backend and opens a backend by name. `scene` reads the physical properties of
tokens. `analytic` simulates the blocks' forward models, and `bullet` uses PyBullet. `pictures` draws recordings.
"""
