"""Read and write task files. Reading returns a checked `Task`, or raises all faults of the file with their places.

::

    task.yaml ─ yaml ─────► plain data, with the line and column of every value
              ─ entries ──► check of keys, types and bounds (pydantic)
              ─ tokens, goals, roles, midlevel ─► check of classes, poses, atoms, agents and hyperparameters
              ─ starts ───► check that no token starts below the floor or inside another token
              ─ loader ───► Task, or one InputError with all faults in the order of the file

`making` builds a task from Python values with the same checks. `saving` writes a task as a file. `domains` finds
domains and task files by name. `schema` describes task files for editors, and `reference` describes them for people.
"""
