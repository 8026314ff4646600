"""Looking at games and episodes, live and recorded: in the browser, in a window, and as films.

A `Recording` is what was played, as arrays; a `SceneView` shows a moment of it in a MuJoCo scene; a `Caption` says in words how
things stand. `viewer` shows one in MuJoCo's own viewer, `video` renders one off-screen.
"""
