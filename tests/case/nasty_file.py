"""A case file with a fault on many of its lines."""

NASTY = '''\
title = 3
tooling = """
[frame]
length_mm = 1
"""

[frame]
length_mm = nan

[diaphragms]
thicknes_mm = 1.5          # "quoted" comment

[materials."my weave"]
kind = "woven"
base = "plain-weave-6k-320"
bending_rigidity_Nmm = [0.3, -0.3]
shear_table.angle_deg = [0, 20, 10]
shear_table.normalised_shear_force_N_mm = [0,
  1]

[[plies]]
size_mm = [350, 350]
element_mm = true

[[plies]]
name = "ply-1"
polygon_mm = [
  [-10, -10],   # a comment with ]
  [10, 10],
  [10, -10],
  [-10, 10],
]
material = "my weav"

[tool]
shape = "hemisphere"
height_mm = 3

[process]
stages = [
  {name = "a", duration_s = 0},
  {name = "b", duration_s = 1, ramp = "smoth"},
]
'''
