"""The symbolic stage: from a task to a checked task plan.

::

    find_plan       Task -> TaskPlan: runs the strategies and returns the best lawful plan
      strategies/     goals planned apart, interchangeable tokens rebound, and the search that they share
      encoding/       Task -> Compilation: operators with meanings, facts, goal (chaining/: series as one block)
      engines/        PlanningProblem -> PlannedActions, in a process that imports unified_planning
      decode          PlannedActions -> instances in order
      schedule        instances in order -> TaskPlan with times (estimates: expected durations)
    reencode        TaskPlan -> PlannedActions of a compiled task
    relaxation      a quick proof that a task has no plan
    pddl/           problems and plans as PDDL text, joins over facts; plan_text reads plans of other planners
    temporal/       the same for PDDL 2.1, with one durative action per block

Only engines/ imports unified_planning, and only inside its worker process.
"""
