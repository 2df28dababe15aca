"""Drawings of reassignment networks: a domain becomes a diagram, a layout, and a file (paper, Figs. 2 and 4).

The input is a `Domain` and, if wanted, the paths of a plan's tokens. The output is a picture (SVG or PNG) with a layout
that is computed here, or a text for Graphviz or Mermaid, which compute their own layouts.
"""
