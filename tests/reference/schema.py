#!/usr/bin/env python3
"""Let the jsonschema package judge what `flow schema` prints: it must be a schema of draft 2020-12, accept every file of
workflows, tests/good and tests/bad/beyond-schema, and refuse every file of tests/bad.

    pip install jsonschema && target/release/flow schema | python3 tests/reference/schema.py

Written against jsonschema 4.25, Python 3.11 (tomllib)."""
import json
import math
import pathlib
import sys
import tomllib

from jsonschema import Draft202012Validator

schema = json.load(sys.stdin)
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
root = pathlib.Path(__file__).resolve().parents[2]


def plain(value):
    """NaN and the infinities are no JSON numbers."""
    if isinstance(value, dict):
        return {name: plain(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def faults(path):
    try:
        value = plain(tomllib.loads(path.read_text()))
    except tomllib.TOMLDecodeError as e:
        return [str(e)]
    return [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(value)]


wrong = 0
for folder, good in [("workflows", True), ("tests/good", True), ("tests/bad/beyond-schema", True), ("tests/bad", False)]:
    for path in sorted((root / folder).glob("*.toml")):
        found = faults(path)
        if good == bool(found):
            wrong += 1
            print(path.relative_to(root), *(found or ["accepted"]), sep="\n  ")
print("wrong:", wrong)
sys.exit(wrong > 0)
