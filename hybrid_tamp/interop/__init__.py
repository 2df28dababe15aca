"""Exchange of tasks, plans and recordings with other tools. Nothing else in the framework imports these tools.

`problems` converts tasks and plans to unified_planning and back. `trajectories` writes recordings as tables.
`environment` makes environments of Gymnasium.
"""
