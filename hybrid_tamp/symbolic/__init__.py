"""The symbolic stage, which turns a task into a checked task plan.

::

    find_plan       Task -> TaskPlan: runs the strategies and returns the best lawful plan
      strategies/     plans goals separately and rebinds interchangeable tokens
      encoding/       Task -> Compilation: operators and their meanings, initial facts, goal
      chaining/       composes blocks in series into one block before the encoding
      whereabouts/    lets feasibility facts depend on the places to which blocks move tokens
      engines/        PlanningProblem -> PlannedActions: runs an engine in a worker process
      decode          PlannedActions -> ordered instances: block instances without times
      estimates       ordered instances -> expected durations
      schedule        ordered instances -> TaskPlan with times
    reencode        TaskPlan -> PlannedActions of a compiled task
    relaxation      quickly proves that some tasks have no plan
    pddl/           writes problems and plans as PDDL text, joins facts
    exported        compiles tasks for other planners and checks their plans
    plan_text       reads plans of other planners from files
    temporal/       exports tasks and plans as PDDL 2.1, with one durative action per block

In the symbolic stage, only engines/ imports unified_planning, and only in the worker process.
"""
