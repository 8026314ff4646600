"""The rule-based player of the thesis: hit, defend, prepare and home, a switcher and a state machine."""
