"""PPO on the batched learners' environments: whole tasks by a network, under constraints by ATACOM."""
