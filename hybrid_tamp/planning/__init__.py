"""A task goes in, a plan outcome comes out: tailor the network, plan, optimise, exclude what failed, plan again."""
