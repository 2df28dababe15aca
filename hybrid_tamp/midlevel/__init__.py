"""The mid-level planner, which turns a task plan into a refined plan (paper, Sec. II-D).

For example, a `TaskPlan` says that the hand is GRASPING the hammer and then STRIKING the nail, both with default
hyperparameters. The `RefinedPlan` says that the hand grasps 0.11 m from the head, because this grasp is best for the
later strike.

::

    TaskPlan ─ rollout ─► objective (violation V, value J) of a whole population at once
                             ├─ screening ──► relevant hyperparameters; all others keep their defaults
                             └─ optimiser ──► best candidate, by CMA-ES (`cma`) or direct sampling (`grid`)
    best candidate ─► RefinedPlan

The optimisers do not depend on plans. They take a `SearchSpace` and a function that maps points to `Scores`.
"""
