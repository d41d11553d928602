#!/usr/bin/python3
"""Holds input files against the schema that `talus schema` prints.

usage: check_schema.py SCHEMA FILE...
Says of every file whether it is valid, as a line "FILE: valid" or "FILE: why not".
"""

import json
import sys
import tomllib

import jsonschema

schema = json.load(open(sys.argv[1]))
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
for name in sys.argv[2:]:
    with open(name, "rb") as file:
        mistakes = list(validator.iter_errors(tomllib.load(file)))
    said = [m.message for mistake in mistakes for m in mistake.context or [mistake]]
    print(f"{name}: {' | '.join(said)[:2000] if said else 'valid'}")
