"""A player that is a network: what it observes, what its action means, and how it plays; `hockey train ppo` makes one."""
