"""Equations of plants and controllers: standard library, numpy and scipy only, no FMI.

`base` says how a model is declared; every other module is one model.
"""
