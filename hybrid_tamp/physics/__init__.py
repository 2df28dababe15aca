"""Who moves the tokens: one protocol, and the backends behind it.

`protocol` says what a backend does and finds one by name; `scene` says what physics needs to know of each token.
`analytic` runs the blocks' own forward models; `bullet` is PyBullet; `pictures` draws what was recorded.
"""
