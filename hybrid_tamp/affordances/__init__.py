"""QUESTIONS about a task, above the verbs: why is there no plan?"""
