"""Reproducing papers: every published number and figure beside the obtained one.

`printed` reads the table of all that the papers print, `page` makes a page of it and of what a paper's module
found, `parameters` compares model parameters with it, `render` writes the page, `papers` lists the papers,
`sampling` changes a step size; every other module belongs to one paper.
These modules alone in the master know `evcosim.models`: closed forms of a paper (gain matrices, equilibria)
are computed there from the same parameters that the FMUs carry.
"""
