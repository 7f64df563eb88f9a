"""The Novint Falcon: three legs, three motors, one serial line."""
