"""Training: rule-based parameters by PGPE and CMA-ES, skills by SAC on the tangent space of the constraints."""
