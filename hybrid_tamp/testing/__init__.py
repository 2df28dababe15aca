"""Checks for authors of domains. Simulations of the blocks (rollouts) are compared with the blocks' declarations.

Input: a task of the domain. Output: a list of disagreements between declarations and rollouts.
"""

from hybrid_tamp.model.disagreement import Disagreement as Disagreement
from hybrid_tamp.testing.check import check_domain as check_domain
from hybrid_tamp.testing.kinds import KINDS as KINDS
from hybrid_tamp.testing.kinds import MistakeKind as MistakeKind
