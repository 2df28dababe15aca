"""VERB 2: a task goes in, a checked task plan comes out.

::

    Task ─ naming ─ encoder ─► Compilation (operators, facts, goal)
                                  ├─ pddl ────► domain.pddl, problem.pddl
                                  └─ planner ─► worker process: unified-planning ─► actions
    actions ─ decoder ─► events ─ schedule ─► TaskPlan

Only this package imports unified_planning, and only inside its worker process.
"""
