"""The symbolic stage, which turns a task into a checked task plan.

::

    find_plan       Task -> TaskPlan: runs the strategies and returns the best lawful plan
      strategies/     plan goals apart, rebind interchangeable tokens; both share one search
      encoding/       Task -> Compilation: operators with meanings, facts, goal
      chaining/       composes blocks in series into one block before the encoding
      engines/        PlanningProblem -> PlannedActions, in a worker process
      decode          PlannedActions -> ordered instances
      estimates       ordered instances -> expected durations
      schedule        ordered instances -> TaskPlan with times
    reencode        TaskPlan -> PlannedActions of a compiled task
    relaxation      quick proof that a task has no plan
    pddl/           problems and plans as PDDL text, joins over facts
    plan_text       reads plans of other planners
    temporal/       encoding and export as PDDL 2.1, with one durative action per block

Only the worker process of engines/ imports unified_planning.
"""
