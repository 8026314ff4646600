"""The sub-commands of `hockey`, one module each; a module imports only what its `--help` needs until it is called."""

from typing import Any

HELP_PAGE: dict[str, Any] = {
    "text_paragraph_linebreaks": "\n\n",
    "options_table_column_types": ["required", "opt_long", "opt_short", "help"],
    "options_table_help_sections": ["help", "required", "default", "metavar"],
    "max_width": 110,
}
