"""The edition that a submission was made for, by what its files say."""

from pathlib import Path

import pytest

from airhockey.agents.packaging.edition import edition_of_entry

BUILDER = "air_hockey_agent/agent_builder.py"
CONFIG = "air_hockey_agent/agent_config.yml"
WRAPPER = "air_hockey_challenge/framework/air_hockey_challenge_wrapper.py"


def entry(place: Path, files: dict[str, str]) -> Path:
    for name, text in ({BUILDER: "def build_agent(env_info): ..."} | files).items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(text)
    return place


@pytest.mark.parametrize(
    ("text", "edition"),
    [
        ('if env_info["env_name"] == "7dof-hit": pass', "2023"),
        ('AGENTS = {"3dof-hit": 1, "7dof-defend": 2}', "2023"),
        ('if env_info["env_name"] == "hit": pass', "2025"),
        ('if self.env_info["env_name"] != "prepare": pass', "2025"),
        ('if env_name in ("hit", "defend"): pass', "2025"),
        ('if env_info.get("env_name") == "defend": pass', "2025"),
        ('agent = {"hit": 1, "defend": 2}[env_info["env_name"]]', "2025"),
        ('match env_name:\n    case "hit":\n        pass', "2025"),
        ('NAMES = ["hit_single"]', "2025"),
        # what agents of every year say:
        ('if "hit" in env_info["env_name"]: pass', None),
        ('if env_info["env_name"].split("-")[1] == "hit": pass', None),
        ('if env_info["env_name"] == "tournament": pass', None),
        ('self.task = "hit"; state = {"hit": 0}; state[self.task]', None),
        ("print 'of another Python'", None),
        ("", None),
    ],
)
def test_by_code(tmp_path: Path, text: str, edition: str | None) -> None:
    assert edition_of_entry(entry(tmp_path, {"air_hockey_agent/agent.py": text})) == edition


@pytest.mark.parametrize(
    ("files", "edition"),
    [
        ({CONFIG: "env: [7dof-hit, tournament]"}, "2023"),
        ({CONFIG: "env: defend"}, "2025"),
        ({CONFIG: "env: tournament"}, None),
        ({CONFIG: "env: [hit, 7dof-hit]"}, None),
        ({CONFIG: "env: [hit]", "air_hockey_agent/a.py": 'NAME = "7dof-hit"'}, "2025"),  # the configuration decides
        ({CONFIG: "env: tournament", WRAPPER: 'ENVIRONMENTS = {"7dof-hit": 1}'}, "2023"),
        ({CONFIG: "env: tournament", WRAPPER: 'ENVIRONMENTS = {"hit": 1, "hit_single": 2}'}, "2025"),
        ({"submission.yaml": "name: a\ntasks: [tournament]\nedition: '2025'"}, "2025"),
        ({"submission.yaml": "name: a\ntasks: [hit_single, defend]"}, "2025"),
        ({"submission.yaml": "name: a\ntasks: [tournament]\nedition: '1999'"}, None),  # its verdict says what is wrong
    ],
)
def test_by_files(tmp_path: Path, files: dict[str, str], edition: str | None) -> None:
    assert edition_of_entry(entry(tmp_path, files)) == edition


def test_what_is_no_submission_has_none(tmp_path: Path) -> None:
    assert edition_of_entry(tmp_path) is None
