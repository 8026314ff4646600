"""Search for the rule-based player's parameters: PGPE (thesis 2.2.3) and CMA-ES, with and without a penalty budget."""
