"""Task files: YAML goes in, a checked `Task` or every fault with its place comes out.

::

    task.yaml ─ yaml ─────► plain data with the line and column of every value
              ─ entries ──► the form: keys, types, bounds (pydantic)
              ─ tokens, goals, roles, midlevel ─► the meaning: classes, poses, atoms, agents, assignment, bounds
              ─ starts ───► whether every token starts clear of the floor and of the others
              ─ loader ───► Task, or one InputError with all faults in the order of the file

`making` sends Python values the same way, and `saving` writes a task as a file. `domains` finds domains and task
files by name. `schema` and `reference` describe the form to editors and to people.
"""
