"""The equations of motion, with losses by load, drag and wind-up of the freewheels, gravity and air.

What is not asked for costs nothing: they are compiled without it, too (docs/mechanics.md, "Losses").
"""
