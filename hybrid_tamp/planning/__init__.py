"""Planning a task: tailor the network, plan, optimise, exclude the binding that failed, replan."""
