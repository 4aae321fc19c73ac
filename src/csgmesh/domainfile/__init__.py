"""Domain files: shapes, mesher, sizes and expectations in YAML."""

from __future__ import annotations

from csgmesh.domainfile.limits import Limits
from csgmesh.domainfile.loader import DomainFile, load
from csgmesh.domainfile.schema import json_schema

__all__ = ["DomainFile", "Limits", "json_schema", "load"]
