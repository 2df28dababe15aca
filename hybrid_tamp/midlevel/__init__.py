"""The mid-level planner: it turns a task plan into a refined plan.

For example, a `TaskPlan` says that the hand is GRASPING the hammer and then STRIKING the nail, each with default
hyperparameters. The `RefinedPlan` says that the hand grasps 0.11 m from the head, because that place suits the later
strike best (paper, Sec. II-D).

::

    TaskPlan ─ rollout ─► objective (violation V, value J) of a whole population at once
                             ├─ screening ──► the hyperparameters that matter; the others keep their defaults
                             └─ optimiser ──► the best candidate: CMA-ES (`cma`) or direct sampling (`grid`)
    best candidate ─► RefinedPlan

The optimisers do not depend on plans: they take a `SearchSpace` and a function from points to `Scores`. Only `cma`
imports cmaes.
"""
