"""Verb 4: a plan becomes a run that really happened.

A thing before and after: before, a `TaskPlan` says that hand and drum enter ROLLING at 3.2 s, an estimate; after, a
`Recording` says that they entered at 3.375 s, because then every condition held in the measured state, and has every
state and command of the run, so that it can be judged, shown and run again bit for bit.

The story, in order: `backend` (who moves the tokens), `commands` (what the robot may command), `scene`, `engine`,
`driving`, `fingers`, `blows` and `bullet` (PyBullet), `analytic` (the blocks' own forward models), `reassignment` (the
plan as an order of events), `running` and `execution` (the closed loop), `events`, `storage`, `replay`, and for
pictures `camera`, `looks`, `rendering`.
"""
