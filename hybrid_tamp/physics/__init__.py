"""Physics backends, which move the tokens, behind one protocol.

`protocol` defines a backend and finds one by name; `scene` holds the physical properties of each token. `analytic` runs
the blocks' own forward models; `bullet` is PyBullet; `pictures` draws recordings.
"""
