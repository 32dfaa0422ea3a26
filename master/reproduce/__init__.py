"""Reproducing papers: every published number and figure beside the one obtained.

`page` says what a page is, `render` writes it, `papers` lists the papers; every other module is one paper.
These modules alone in the master know `evcosim.models`: closed forms of a paper (gain matrices, equilibria)
are computed there from the same parameters that the FMUs carry.
"""
