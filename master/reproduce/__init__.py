"""Reproducing papers: every published number and figure beside the obtained one.

`page` defines a page, `render` writes it, `papers` lists the papers; every other module belongs to one paper.
These modules alone in the master know `evcosim.models`: closed forms of a paper (gain matrices, equilibria)
are computed there from the same parameters that the FMUs carry.
"""
