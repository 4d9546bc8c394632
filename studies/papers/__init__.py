"""The three source papers: every equation as printed and exact, every claim with what was found.

karetin: V. Karetin, Kinematic study of the standard layout circuit of the inertia module,
Scientific Horizons 07 (92), 2020, 104-111. lysenko: V. S. Lysenko, S. Zh. Praliev, B. T. Suleimenov,
S. D. Baubekov, Analysis of the inertial gear. stelmashchuk: S. H. Stelmashchuk, stepping mechanism of
partially-toothed wheels with a balancing device.
"""
