"""What members say is what the schemas in firmware/fleet/schema promise, by a validator that knows
nothing of the program. Usage: schema_test.py SAMPLES (the program that prints messages)."""

import copy
import json
import subprocess
import sys
from pathlib import Path

import jsonschema

SCHEMAS = Path(__file__).resolve().parents[2] / "firmware/fleet/schema"


def undescribed(schema, value, root):
    """Fields of the value that the schema has no word for."""
    if "$ref" in schema:
        schema = root["$defs"][schema["$ref"].rsplit("/", 1)[1]]
    if isinstance(value, dict) and "properties" in schema:
        for key, inner in value.items():
            if key not in schema["properties"]:
                yield key
            else:
                yield from undescribed(schema["properties"][key], inner, root)
    elif isinstance(value, list) and "items" in schema:
        for inner in value:
            yield from undescribed(schema["items"], inner, root)


def main():
    validators = {}
    for path in SCHEMAS.glob("*.json"):
        schema = json.loads(path.read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        validators[path.stem] = jsonschema.Draft202012Validator(schema)
    lines = subprocess.run(sys.argv[1:], check=True, capture_output=True, text=True).stdout
    seen = {}
    wrong = 0
    for line in lines.splitlines():
        kind, payload = line.split(" ", 1)
        message = json.loads(payload)
        schema = validators[kind].schema
        complaints = [error.message for error in validators[kind].iter_errors(message)]
        complaints += [f"{key} is not described" for key in undescribed(schema, message, schema)]
        for complaint in complaints:
            print(f"{kind}: {complaint}: {payload}")
            wrong += 1
        seen.setdefault(kind, []).append(message)

        # And without any of the fields that it demands it is none.
        for key in schema["required"]:
            less = copy.deepcopy(message)
            del less[key]
            if validators[kind].is_valid(less):
                print(f"{kind}: is sound without {key}")
                wrong += 1
    for kind in sorted(set(validators) - set(seen)):
        print(f"{kind}: nobody said anything of the kind")
        wrong += 1
    described = set(validators["node"].schema["properties"])
    said = set().union(*seen["node"])
    if described != said:
        print(f"node: {sorted(described - said)} are in no sample")
        wrong += 1
    print({kind: len(messages) for kind, messages in sorted(seen.items())}, f"{wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
