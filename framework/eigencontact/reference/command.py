"""Text of the command `eigencontact schema`."""

from __future__ import annotations

import json

from eigencontact.hooks.registry import Registry

__all__ = ["schema_text"]


def schema_text(registry: Registry, place: str | None, *, as_json: bool) -> str:
    """Reference of a scene or of one of its tables; as JSON a JSON Schema of the scene, or the keys of the table.

    Raises
    ------
    SceneError
        A scene has no such table; names the nearest.
    """
    if place is None and as_json:
        from eigencontact.reference.json_schema import json_schema

        return json.dumps(json_schema(registry), indent=2)
    from eigencontact.reference.tables import all_tables, one_table
    from eigencontact.reference.text import as_data, overview, table_text

    if place is None:
        return overview(all_tables(registry))
    table = one_table(registry, place)
    return json.dumps(as_data({table.place: table}), indent=2) if as_json else table_text(table)
