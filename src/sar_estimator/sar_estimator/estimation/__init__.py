"""The helicopter's motion, its leg and the corner ahead, from GPS fixes."""
