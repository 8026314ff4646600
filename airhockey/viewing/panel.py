"""The panel in MuJoCo's viewer: how things stand, buttons, and the marks in the scene. Runs in the viewer's thread."""

from dataclasses import dataclass
from typing import Any

from mujoco.studio import messages, plugin, ux
from mujoco.studio.app import inputs
from mujoco.studio.dear_imgui import dear_imgui as imgui

from airhockey.envs.rendering.camera import look_from_above, look_from_stands
from airhockey.envs.rendering.marks import Mark, geoms
from airhockey.viewing.caption import Caption

Color = tuple[float, float, float]
INK: Color = (0.93, 0.94, 0.96)
FAINT: Color = (0.65, 0.69, 0.75)
NEWS: Color = (1.00, 0.84, 0.40)
ALARM: Color = (1.00, 0.48, 0.41)
PLAYERS: tuple[Color, Color] = (0.45, 0.68, 1.0), (0.40, 0.85, 0.55)
_WIDTH, _MARGIN = 500.0, 12.0  # of the panel, in pixels
_LARGE = 1.5
_NOWHERE = -1e30  # less than any place on a screen
_IMGUI_KEYS = {
    "Space": "pause",
    "Period": "step",
    "RightArrow": "step",
    "Comma": "back",
    "LeftArrow": "back",
    "Equal": "faster",
    "KeypadAdd": "faster",
    "Minus": "slower",
    "KeypadSubtract": "slower",
    "R": "restart",
    "N": "next",
    "P": "previous",
}
"""Key of the viewer -> command; "q" quits in the terminal only, since a spectator's key is not to end it for all."""


@dataclass(frozen=True)
class PlaybackState(messages.Snapshot):
    """From the playback to the panel.

    Attributes:
        caption: How things stand.
        marks: To be drawn.
        step, steps, episode, episodes, can_go_back, paused, speed: See `Playback` and `PlaybackControls`.
        robots: Number of arms in the scene.
    """

    caption: Caption
    marks: tuple[Mark, ...]
    step: int
    steps: int
    episode: int
    episodes: int | None
    can_go_back: bool
    paused: bool
    speed: float
    robots: int


@dataclass(frozen=True)
class Command(messages.Event):
    """From the panel to the playback: a command of `PlaybackControls`, "seek" with a step, or "connected"."""

    command: str
    step: int = 0


class Panel(plugin.ViewerPlugin):
    """Draws the panel and says what was pressed."""

    def __init__(self) -> None:
        self._view: PlaybackState | None = None
        self._connected = False
        self._ux = ux.UxState()
        self._fresh = True

    @messages.handler
    def on_view(self, view: PlaybackState) -> None:
        """Keep the latest."""
        self._view = view
        self.viewer.extra_geoms[:] = geoms(view.marks)

    @messages.handler
    def on_model(self, event: messages.PostModelEvent) -> None:
        """Another scene: look at it from the stands again."""
        self._fresh = True

    @messages.handler
    def on_update(self, event: messages.UpdateEvent) -> None:
        """Keys and mouse."""
        if not self._connected and imgui.GetIO().MousePos.x > _NOWHERE:  # a page is open, and sends where its mouse is
            self._connected = True
            self.viewer.send_to_sim(Command("connected"))
        viewer = self.viewer
        if self._fresh and self._view is not None:
            self._look("stands")
            self._fresh = False
        if viewer.client_camera is None:
            inputs.handle_mouse_events(
                viewer.model, viewer.data, viewer.camera, viewer.vis_options, viewer.perturb, self._ux
            )
        for key, command in _IMGUI_KEYS.items():
            if imgui.IsKeyPressed(getattr(imgui.Key, key), command in ("step", "back")):
                viewer.send_to_sim(Command(command))

    @messages.handler
    def on_gui(self, event: messages.BuildGuiEvent) -> None:
        """Draw the panel."""
        if self._view is None:
            return
        ux.setup_theme(ux.GuiTheme.DARK)
        middle = imgui.GetIO().DisplaySize.x / 2
        imgui.SetNextWindowPos(imgui.Vec2(middle, _MARGIN), int(imgui.Cond.Always), imgui.Vec2(0.5, 0.0))
        imgui.SetNextWindowSize(imgui.Vec2(_WIDTH, 0.0), int(imgui.Cond.Always))
        imgui.SetNextWindowBgAlpha(0.88)
        kinds = imgui.WindowFlags
        imgui.Begin(
            "airhockey", flags=sum(int(kind) for kind in (kinds.NoDecoration, kinds.NoSavedSettings, kinds.NoMove))
        )
        self._say(self._view.caption)
        imgui.Separator()
        self._controls(self._view)
        self._cameras(self._view.robots)
        imgui.End()

    def _say(self, caption: Caption) -> None:
        _text(FAINT, caption.title)
        _right(INK, caption.clock)
        imgui.SetWindowFontScale(_LARGE)
        if caption.score is None:
            _text(PLAYERS[0], caption.players[0])
        else:
            home, away = caption.players
            _text(PLAYERS[0], f"{home}  {caption.score[0]}")
            imgui.SameLine()
            _text(INK, ":")
            imgui.SameLine()
            _text(PLAYERS[1], f"{caption.score[1]}  {away}")
        imgui.SetWindowFontScale(1.0)
        counted = [
            f"{what} " + " : ".join(f"{value:g}" for value in values)
            for what, values in (("faults", caption.faults), ("penalty", caption.penalty))
            if values is not None
        ]
        if counted:
            _right(FAINT, "   ".join(counted))
        for k, phase in enumerate(caption.phases):
            _text(PLAYERS[k], phase or " ")
            if k == 0 and len(caption.phases) > 1:
                imgui.SameLine(_WIDTH / 2)
        _text(ALARM if caption.alarm else NEWS, caption.alarm or caption.news or " ")

    def _controls(self, view: PlaybackState) -> None:
        """Buttons, and a slider where the playback can go back."""
        for label, command in (
            ("go on" if view.paused else "pause", "pause"), ("step", "step"), ("restart", "restart"),
            ("-", "slower"), ("+", "faster"),
        ):  # fmt: skip
            self._button(label, command)
        imgui.TextUnformatted(f"{view.speed:g} x")
        imgui.SameLine(_WIDTH - 175.0)
        self._button("<", "previous")
        self._button(">", "next")
        of = f" {view.episode + 1} of {view.episodes}" if view.episodes is not None else ""
        imgui.TextUnformatted(f"episode{of}")
        if view.can_go_back:
            imgui.SetNextItemWidth(-1.0)
            changed, step = imgui.SliderInt("##step", view.step, 0, max(view.steps, 1), "step %d")
            if changed:
                self.viewer.send_to_sim(Command("seek", step))

    def _button(self, label: str, command: str) -> None:
        if imgui.Button(f"{label}##{command}"):
            self.viewer.send_to_sim(Command(command))
        imgui.SameLine()

    def _cameras(self, robots: int) -> None:
        for look in ("stands", "above", "player 1", "player 2")[: 2 + robots]:
            if imgui.Button(look):
                self._look(look)
            imgui.SameLine()
        _right(FAINT, "keys: space . , + - r n p")

    def _look(self, look: str) -> None:
        """Move the camera, which stays free to be turned."""
        camera = look_from_above(fill=1.35) if look == "above" else self._from_stands()
        if look.startswith("player"):
            side = -1.0 if look == "player 1" else 1.0
            camera.lookat[:] = (-0.2 * side, 0.0, 0.0)
            camera.azimuth, camera.elevation, camera.distance = (0.0 if side < 0 else 180.0), -30.0, 2.9
        target = self.viewer.camera
        target.type, target.fixedcamid, target.trackbodyid = camera.type, camera.fixedcamid, camera.trackbodyid
        target.lookat[:] = camera.lookat
        target.azimuth, target.elevation, target.distance = camera.azimuth, camera.elevation, camera.distance

    def _from_stands(self) -> Any:
        assert self._view is not None
        return look_from_stands(self._view.robots, 16 / 10)


def _text(color: Color, text: str) -> None:
    imgui.PushTextWrapPos(_WIDTH - _MARGIN)
    imgui.TextColored(imgui.Vec4(*color, 1.0), text)
    imgui.PopTextWrapPos()


def _right(color: Color, text: str) -> None:
    """Text at the right end of the present line."""
    imgui.SameLine(max(0.0, _WIDTH - _MARGIN - imgui.CalcTextSize(text).x))
    _text(color, text)
