"""Tables of the JSON Schema of scenarios."""


def tables_of(schema):
    """Yield the name and the properties of each table."""
    yield "scenario", schema["properties"]
    for name, one in schema["$defs"].items():
        yield name, one["properties"]
