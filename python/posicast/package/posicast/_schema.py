"""JSON Schemas of the machine file and of documents."""

from __future__ import annotations

import json
from typing import Any, Dict

from . import _native
from ._errors import InputError


def schema(name: str = "machine-file") -> Dict[str, Any]:
    """Return the JSON Schema of the machine file, or of a document: ``report``, ``design``, ``compare``, ``generate``, ``verify`` and others.

    Raises
    ------
    InputError
        For a name that does not exist, with those that do.

    Examples
    --------
    >>> import posicast
    >>> sorted(posicast.schema("design")["properties"])[:3]
    ['axes', 'fronts', 'inline']
    """
    text = _native.schema(name)
    if text is None:
        raise InputError(f"name: found {name!r}; allowed: {', '.join(_native.schema_names())}", remedy="leave it out for the machine file")
    found: Dict[str, Any] = json.loads(text)
    return found
