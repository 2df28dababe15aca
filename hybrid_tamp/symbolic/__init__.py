"""A task goes in, a checked task plan comes out.

::

    find_plan       Task -> TaskPlan: the strategies, one after the other; the best lawful plan wins
      strategies/     goals planned apart, interchangeable tokens rebound; what their search shares
      encoding/       Task -> Compilation: operators with meanings, facts, goal (chaining/: series as one block)
      engines/        PlanningProblem -> PlannedActions, in a process that imports unified_planning
      decode          PlannedActions -> instances in order
      schedule        instances in order -> TaskPlan with times (estimates: how long each is going to last)
    reencode        TaskPlan -> PlannedActions of a compiled task
    relaxation      whether a task may be solvable, by a quick test
    pddl/           problems and plans as PDDL text; plan_text reads plans of other planners
    temporal/       the same for PDDL 2.1, one durative action a block

Only engines/ imports unified_planning, and only inside its worker process.
"""
