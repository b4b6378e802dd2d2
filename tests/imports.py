"""What a file of Python imports, anywhere in it."""

import ast


def imports_of(file):
    """Yield each import as (module, name): ("a.b", "c") of ``from a.b import c``, ("a.b", "") of ``import a.b``."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (("." * node.level + (node.module or ""), alias.name) for alias in node.names)
