"""VERB 3: a task plan becomes a refined plan.

A thing before and after it: before, a `TaskPlan` says that the hand is GRASPING the hammer and STRIKING the nail
afterwards, each with its default hyperparameters; after, a `RefinedPlan` says that it grasps 0.11 m from the head,
because of all places there this one suits the strike best that comes later (paper, Sec. II-D).

::

    TaskPlan ─ rollout ─► objective (violation V, value J) of a whole population at once
                             ├─ screening ──► the hyperparameters that matter; the others keep their defaults
                             └─ optimiser ──► the best candidate: CMA-ES (`cma`) or direct sampling (`grid`)
    best candidate ─► RefinedPlan

The optimisers know nothing of plans: they take a `SearchSpace` and a function from points to `Scores`. Only `cma`
imports cmaes.
"""
