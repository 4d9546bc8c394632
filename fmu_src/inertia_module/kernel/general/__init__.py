"""The general equations of motion: losses by load, drag and wind-up of the freewheels, gravity.

Used only where one of these is asked for; the other solvers do not know them (docs/mechanics.md, "Losses").
"""
