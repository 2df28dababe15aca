"""QUESTIONS about a task, above the verbs: which part of the network does it take? why is there no plan?"""
