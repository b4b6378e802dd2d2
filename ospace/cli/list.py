"""``ospace list``: the robots and scenarios that come with ospace, and the codes of findings, each with what it is."""

from __future__ import annotations

import argparse
import json
from typing import Any

from ospace.cli.columns import Column
from ospace.cli.console import buffered_console, buffered_text, plain, show_table

PAGE = "command_line"
EXAMPLES = ("ospace list", "ospace list scenarios", "ospace list examples", "ospace list findings --json")
_KINDS = ("robots", "scenarios", "examples", "findings")


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    verb = verbs.add_parser(
        "list",
        help="list robots, scenarios and examples that come with ospace, and codes of findings",
        description="List the robots and scenarios that come with ospace, by the names that other commands take, "
        "scripts to run or to copy by their paths, and the codes of findings, which `ospace check --explain CODE` "
        "explains.",
    )
    verb.add_argument("kind", metavar="KIND", nargs="?", choices=_KINDS, help=f"{', '.join(_KINDS)} (default: all)")
    verb.add_argument("--json", action="store_true", help="print one JSON document instead")
    verb.set_defaults(run=run)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """List; return the exit status and the text to print."""
    kinds = {kind: _entries(kind) for kind in ([given.kind] if given.kind else _KINDS)}
    if given.json:
        listed = {
            kind: [{"name": name, "summary": what} for name, what in all_of.items()] for kind, all_of in kinds.items()
        }
        return 0, json.dumps(listed, indent=2, ensure_ascii=False) + "\n"
    texts = [("" if given.kind else f"{kind}\n") + _table(entries) for kind, entries in kinds.items()]
    return 0, "\n".join(texts)


def _entries(kind: str) -> dict[str, str]:
    """Return names, and what each is."""
    from ospace import models

    if kind == "robots":
        return {name: models.summary(name) for name in models.names()}
    if kind == "examples":
        return {str(file): models.example_summary(file) for file in models.examples()}
    if kind == "scenarios":
        return {name: models.scenario_summary(name) for name in models.scenarios()}
    from ospace.urdf.lint.rules import RULES

    return {rule.name: f"{'refused' if rule.unreadable else rule.severity}: {rule.summary}" for rule in RULES.values()}


def _table(entries: dict[str, str]) -> str:
    """Return a name for each, and beside it what it is."""
    console = buffered_console()
    show_table(console, (Column(), Column(wraps=True)), [(plain(name), plain(what)) for name, what in entries.items()])
    return buffered_text(console)
