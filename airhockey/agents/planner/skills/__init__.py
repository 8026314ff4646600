"""What the planner can do: one skill a module, each with its `Skill` interface (`airhockey.agents.skill`)."""
