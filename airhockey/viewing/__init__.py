"""Looking at games and episodes, live and recorded: in the browser, in a window, and as films.

A `Recording` is what was played, as arrays; a `Stage` shows a moment of it in a MuJoCo scene; a `Caption` says in words how
things stand. `studio` shows a stage in MuJoCo's own viewer, `video` renders one off-screen.
"""
