"""Checks for authors of domains: rollouts of the blocks are compared with the declarations of the blocks.

Input: a task of the domain. Output: a list of disagreements between declarations and rollouts.
"""

from hybrid_tamp.testing.check import check_domain as check_domain
from hybrid_tamp.testing.disagreement import Disagreement as Disagreement
