"""Planning of a task: tailor the network, plan, optimise, and replan without the bindings that failed."""
