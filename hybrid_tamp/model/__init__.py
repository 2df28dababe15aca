"""The nouns: what tasks, domains, plans and recordings are made of.

Nothing here plans, simulates, reads or writes files; every verb package builds on this one.
"""
