"""Read and write task files: from YAML to a checked `Task`, or to a list of all faults with their places.

::

    task.yaml ─ yaml ─────► plain data, with the line and column of every value
              ─ entries ──► check of the form: keys, types, bounds (pydantic)
              ─ tokens, goals, roles, midlevel ─► check of the meaning: classes, poses, atoms, agents, bounds
              ─ starts ───► check that every token starts clear of the floor and of the others
              ─ loader ───► Task, or one InputError with all faults in the order of the file

`making` checks Python values in the same way, and `saving` writes a task as a file. `domains` finds domains and task
files by name. `schema` and `reference` describe the form for editors and for people.
"""
