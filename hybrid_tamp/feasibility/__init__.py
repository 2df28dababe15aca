"""What a task's tokens can do at all: bindings, shares of a load, passages of the network, relevance."""
