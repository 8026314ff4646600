"""Skills by Soft Actor Critic (or its optimistic kin) on Gymnasium, acting through ATACOM."""
