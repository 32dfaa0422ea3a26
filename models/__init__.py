"""Equations of plants and controllers: standard library, numpy and scipy only, no FMI.

`base` declares models and `constants` holds the numbers that they share. Every other module is one model, or
holds equations that models or the tables of the docs use.
"""
