"""Equations of plants and controllers, without FMI; those that run in an FMU need the standard library alone.

`base` declares models and `constants` holds the numbers that they share. Every other module is one model, or
holds equations that models or the tables of the docs use; those of the tables (`..._analysis`, `..._limits`)
use numpy and scipy.
"""
