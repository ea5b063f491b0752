-- A ball pushed beside its centre of mass, with unequal moments: the general rotation takes the place of the plain one.
world { method = "classic", duration = 0.5, gravity_force = {0, 0, 0.5} }
sphere { radius = 0.125, mass = 2, center_of_mass = {0, 0.03125, 0}, inertia = {0.01, 0.02, 0.025},
	forces = { { vector = {10, 0, 0}, point = {0, 0, 0}, duration = 0.125 } } }
