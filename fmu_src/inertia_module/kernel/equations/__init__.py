"""Equations of motion with losses, drag and wind-up of the freewheels, gravity and windage.

An ideal module is compiled without the loss terms (losses.md, "Load-dependent losses").
"""
