(define (problem roll_cylinder_off_axis)
  (:domain rolling_tumbling)
  (:objects
    drum - rollable
    goal - region
    hand - static-end-effector
    n1 - how-many
  )
  (:init
    (at_rest drum)
    (at_rest hand)
    (completed drum)
    (completed hand)
    (idle)
    (in-resting drum)
    (in-resting hand)
    (in_workspace hand)
    (inside drum no-region-of-inside)
    (lies_on_side drum)
    (next none-reading n1)
    (readers drum none-reading)
    (readers hand none-reading)
    (settled drum)
    (settled hand)
    (unclaimed drum)
    (unclaimed hand)
    (within_workspace hand drum goal)
  )
  (:goal
    (and
      (completed drum)
      (idle)
      (inside drum goal)
      (unclaimed drum)
    )
  )
)
