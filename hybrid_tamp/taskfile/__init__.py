"""VERB 1: a YAML task file goes in, a sound `Task` or every fault with its place comes out.

::

    task.yaml ─ yaml_nodes ─► plain data, the line and column of every part, no object ever constructed
              ─ entries ────► the file's form: keys, types, bounds (pydantic)
              ─ tokens, goals, roles ─► its meaning: classes, poses, atoms, agents, starts
              ─ starts ─────► whether tokens can be where they start, clear of the floor and of each other (convex)
              ─ loader ─────► Task, or one InputError with all faults in the order of the file

`domains` finds what a file names; `schema` and `reference` say the file's form to editors and to people.
"""
