"""How a vehicle moves: three models with one face, `sim.models.motion.Motion`, chosen once with the airframe."""
