"""The mid-level planner, which turns a task plan into a refined plan (paper, Sec. II-D).

For example, a `TaskPlan` contains GRASPING of a hammer and then STRIKING of a nail, both with default hyperparameters.
In the `RefinedPlan`, the hand grasps the hammer 0.11 m from its head, because this grasp is best for the later strike.

::

    TaskPlan ─ rollout ─► objective (violation V, value J) of a whole population at once
                             ├─ screening ──► relevant hyperparameters; all others keep their defaults
                             └─ optimiser ──► best candidate, by CMA-ES (`cma`) or direct sampling (`grid`)
    best candidate ─► RefinedPlan

A candidate is one choice of all hyperparameters. V sums how far the candidate misses each condition. J is the weighted
sum of the performance measures. The optimisers do not depend on plans: an optimiser gets a `SearchSpace` and a function
that maps points to `Scores`.
"""
