"""Pictures of the scene: off-screen, where there is no display, for films, the viewer and `render()` of the interfaces."""
