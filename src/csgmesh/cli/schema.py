"""``csgmesh schema``: the JSON Schema of domain files."""

from __future__ import annotations

import json

import typer


def schema() -> None:
    """Print the JSON Schema of domain files, for editors that complete and check YAML."""
    from csgmesh.domainfile import json_schema

    typer.echo(json.dumps(json_schema(), indent=2))
