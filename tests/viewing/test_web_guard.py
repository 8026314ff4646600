"""Who may talk to the web viewer."""

import pytest
from websockets.datastructures import Headers

from airhockey.envs.rendering.guard import Guard


@pytest.fixture
def guard() -> Guard:
    return Guard("127.0.0.1", 8080)


@pytest.mark.parametrize(
    ("headers", "why"),
    [
        ({}, None),
        ({"Host": "localhost:9000"}, None),
        ({"Host": "[::1]:8080"}, None),
        ({"Origin": "http://127.0.0.1:8080"}, None),
        ({"Host": "evil.example:8080"}, "host"),
        ({"Host": "localhost.evil.example"}, "host"),
        ({"Origin": "http://evil.example"}, "page"),
        ({"Origin": "http://127.0.0.1:9999"}, "page"),
        ({"Origin": "null"}, "page"),
    ],
)
def test_hosts_and_origins(guard: Guard, headers: dict[str, str], why: str | None) -> None:
    said = guard.refusal(f"/?token={guard.token}", Headers({"Host": "127.0.0.1:8080", **headers}))
    assert (said is None) if why is None else (why in str(said))


def test_the_token_or_the_cookie_that_it_gives(guard: Guard) -> None:
    here = Headers({"Host": "127.0.0.1:8080"})
    for target in ("/", "/?token=", "/?token=wrong", "/ui?sid=1", "/state", "/model"):
        assert "token" in str(guard.refusal(target, here))
    here["Cookie"] = "other=1; " + guard.set_cookie.split(";")[0]
    for target in ("/", "/ui?sid=1", "/state", "/model"):
        assert guard.refusal(target, here) is None
    wrong = Headers({"Host": "127.0.0.1:8080", "Cookie": "hockey-8080=wrong"})
    assert guard.refusal("/ui", wrong) is not None


def test_two_viewers_have_two_tokens() -> None:
    assert Guard("::1", 1).token != Guard("::1", 2).token


def test_a_running_viewer_answers_only_those(monkeypatch: pytest.MonkeyPatch) -> None:
    import urllib.error
    import urllib.request

    mujoco = pytest.importorskip("mujoco")
    from airhockey.envs.rendering import web

    model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    handle, address = web.launch("test", (model, mujoco.MjData(model)), "127.0.0.1", 0)
    try:
        with urllib.request.urlopen(address, timeout=20) as answer:
            assert answer.status == 200 and "SameSite=Strict" in answer.headers["Set-Cookie"]
            assert answer.headers["Access-Control-Allow-Origin"] is None
        for target, headers in (
            (address.split("?")[0], {}),
            (address.split("?")[0] + "model", {}),
            (address, {"Origin": "http://evil.example"}),
            (address, {"Host": "evil.example"}),
        ):
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(urllib.request.Request(target, headers=headers), timeout=20)
    finally:
        handle.close()
