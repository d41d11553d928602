#!/usr/bin/python3
"""Builds the site from docs/ and what stands beside it: `./dev docs`.

    scripts/site.py TALUS FOLDER

FOLDER/site is the site. Pages are docs/**.md, the README.md of validation/, its folders and benchmarks/, CONTRIBUTING.md
and CHANGELOG.md. Other files that they link to become text files of the site. The program TALUS prints the tables of
docs/reference.md; figures come from out/reproduce, where `talus reproduce all` writes them.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

root = pathlib.Path(__file__).resolve().parent.parent
talus, folder = (pathlib.Path(a).resolve() for a in sys.argv[1:])
source, site = folder / "site_source", folder / "site"
katex = pathlib.Path("/usr/share/javascript/katex")
link = re.compile(r"(!?\[[^\]]*\]\()([^)\s]+)(\))")


def pages():
    """The pages, as paths from the root."""
    found = [*(root / "docs").rglob("*.md"), *(root / "validation").rglob("README.md"), root / "benchmarks/README.md",
             root / "CONTRIBUTING.md", root / "CHANGELOG.md"]
    return sorted(p.relative_to(root) for p in found)


def place_of(path):
    """Path in the site of a file of the repository; none if it is neither a page nor a picture or notebook of docs/."""
    if path.parts[0] == "docs":
        return pathlib.Path(*path.parts[1:])
    return path if path in pages() else None


def rewritten(text, page):
    """Text of a page with the links of the site. Linked files that are not pages are copied into the site as text."""
    here = place_of(page).parent

    def mend(found):
        before, target, after = found.groups()
        if re.match(r"[a-z]+:|#", target):
            return found.group()
        target, _, anchor = target.partition("#")
        path = pathlib.Path(os.path.normpath(page.parent / target))
        place = place_of(path)
        if place is None and (root / path).is_dir():
            return before + "#" + after  # a folder has no page
        if place is None:
            place = pathlib.Path("files") / (str(path) + ".txt")
            (source / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(root / path, source / place)
        return before + os.path.relpath(place, here) + ("#" + anchor if anchor else "") + after

    parts = re.split(r"(^```.*?^```)", text, flags=re.M | re.S)  # code stays as it is
    return "".join(p if p.startswith("```") else link.sub(mend, p) for p in parts)


def figures():
    """A page of the recomputed figures, or how to compute them."""
    made = root / "out/reproduce"
    text = ["# Figures", ""]
    if not (made / "index.html").exists():
        return "\n".join(text + [
            "This site was built without figures. Run `talus reproduce all`, then `./dev docs`, to see them here."])
    shutil.copytree(made, source / "validation/reproduced",
                    ignore=lambda folder, names: [n for n in names if n.endswith((".hdf", ".h5", ".series"))])
    text += ["Recomputed by `talus reproduce all`. [All verdicts on one page](reproduced/index.html).", ""]
    for folder in sorted((root / "validation").iterdir()):
        page = made / folder.name / "index.html"
        if not (folder / "figure.toml").exists() or not page.exists():
            continue
        figure = tomllib.loads((folder / "figure.toml").read_text())
        text += [f"## {figure['title']}", "", f"{figure.get('source', '')}. [Curves and verdicts](reproduced/{folder.name}/index.html).", ""]
        pictures = [f"reproduced/{folder.name}/{panel['name']}.svg" for panel in figure.get("panel", [])]
        text += [" ".join(f"![]({p})" for p in pictures if (source / "validation" / p).exists()), ""]
    return "\n".join(text)


def takes(value):
    """Type of the value of a key, in a few words."""
    if "anyOf" in value:
        return " or ".join(dict.fromkeys(takes(v) for v in value["anyOf"]))
    if "oneOf" in value:
        return ", ".join(f"`{w['const']}`" for w in value["oneOf"])
    if "enum" in value:
        return ", ".join(f"`{w}`" for w in value["enum"])
    kind = value.get("type", "")
    if kind == ["number", "string"]:
        return "number or text with %"
    if kind == "array":
        n = value.get("minItems", 0) if value.get("minItems") == value.get("maxItems") else 0
        return f"list of {str(n) + ' x ' if n > 1 else ''}{takes(value['items'])}"
    if "properties" in value:
        return "table"
    if kind == "string":
        return "text with unit" if "pattern" in value else "text"
    return {"number": "number", "integer": "whole number", "boolean": "`true`, `false`"}.get(kind, "")


def meaning(value):
    if "anyOf" in value:
        return "<br>".join(dict.fromkeys(m for v in value["anyOf"] if (m := meaning(v))))
    words = [f"`{w['const']}`: {w['description']}" for w in value.get("oneOf", []) if w.get("description")]
    return "<br>".join([value.get("description", ""), *words])


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def table_of(values, required):
    alike = {}  # keys with the same description share a row
    for key, value in values.items():
        if takes(value) or meaning(value):
            alike.setdefault((takes(value), cell(meaning(value)), key in required), []).append(f"`{key}`")
    rows = [f"| {', '.join(keys)}{'' if needed else ' (optional)'} | {what} | {means} |"
            for (what, means, needed), keys in alike.items()]
    return ["| key | value | meaning |", "|---|---|---|", *rows, ""] if rows else []


def inner_of(value):
    """The section under a key and the rest of its name; none if the key has no section."""
    for way in [value, *value.get("anyOf", [])]:
        more = way.get("additionalProperties")
        if "properties" in way:
            return "", way
        if "properties" in way.get("items", {}):
            return "[0]", way["items"]
        if isinstance(more, dict) and "properties" in more:
            return ".NAME", more
    return None


def section(name, schema, depth):
    """Tables of a section, then of those inside it."""
    keys, required = schema["properties"], schema.get("required", [])
    own = {k: v for k, v in keys.items() if not inner_of(v) or "anyOf" in v}
    branches = [(*next(iter(b["if"]["properties"].items())), b["then"]) for b in schema.get("allOf", []) if "if" in b]
    one_of = [[w["required"][0] for w in b["oneOf"]] for b in schema.get("allOf", []) if "oneOf" in b]
    of_some = [k for k in own if any(then.get("properties", {}).get(k) is False for *_, then in branches)]
    shown = f"[[{name[:-3]}]]" if name.endswith("[0]") else f"[{name.replace('[0]', '')}]"
    text = [f"{'#' * depth} `{shown}`" if name else "", ""]
    text += table_of({k: v for k, v in own.items() if k not in of_some}, required)
    for ways in one_of:
        text += [f"Exactly one of {', '.join(f'`{k}`' for k in ways)} is required.", ""]
    for key, value, then in branches:  # keys of single choices
        here = {k: then.get("properties", {}).get(k, own[k]) for k in of_some}
        table = table_of({k: v for k, v in here.items() if v is not False}, required + then.get("required", []))
        if table:
            text += [f"With `{key} = \"{value['const']}\"`:", "", *table]
    parts = {}  # equal sections appear once
    for key, value in keys.items():
        if inner := inner_of(value):
            path = (f"{name}." if name else "") + key + inner[0]
            heading, *rest = section(path, inner[1], min(depth + 1, 4) if name else depth)
            parts.setdefault("\n".join(rest).replace(path, ""), (heading, rest, []))[2].append(key)
    for heading, rest, (_, *others) in parts.values():
        text += [heading, "", *(["The same for " + ", ".join(f"`{k}`" for k in others) + ".", ""] if others else []), *rest]
    return text


def tables():
    """The tables of docs/reference.md, from `talus schema`, which prints the declarations of the readers."""
    schema = json.loads(subprocess.run([talus, "schema"], check=True, capture_output=True, text=True).stdout)
    text = []
    for kind in schema["anyOf"]:
        text += ["", f"## {kind['title'].capitalize()}", "", *section("", kind, 3)]
    listed = subprocess.run([talus, "list"], check=True, capture_output=True, text=True).stdout
    text += ["", "## Quantities, choices and outputs of laws", "", "Output of `talus list`.", "", "```text", listed.rstrip(), "```", ""]
    return "\n".join(text)


def write_search_from_disk():
    """Writes the search index and the search worker as one script: a browser lets pages on the disk load scripts, but neither
    data nor workers."""
    (worker,) = (site / "assets/javascripts/workers").glob("search.*.min.js")
    code = re.sub(r"^//# sourceMappingURL.*$", "", worker.read_text(), flags=re.M)
    index = (site / "search/search_index.json").read_text()
    (site / "search/from_disk.js").write_text(
        f"var __search = {{index: Promise.resolve({index}),\n"
        f"  worker: URL.createObjectURL(new Blob([{json.dumps(code)}], {{type: 'text/javascript'}}))}};\n")


def main():
    shutil.rmtree(source, ignore_errors=True)
    for page in pages():
        place = source / place_of(page)
        place.parent.mkdir(parents=True, exist_ok=True)
        wide = "---\nhide: [toc]\n---\n\n" if page.stem in ("index", "gallery") else ""  # no table of contents beside them
        place.write_text(wide + rewritten((root / page).read_text(), page))
    shutil.copytree(root / "docs/images", source / "images")
    shutil.copytree(root / "docs/notebooks", source / "notebooks")
    for part in ("site.js", "site.css"):
        shutil.copyfile(root / "docs/site" / part, source / part)
    shutil.copyfile(root / "docs/site/mkdocs.yml", folder / "mkdocs.yml")
    for part in ("katex.min.css", "katex.min.js", "contrib/auto-render.js"):
        (source / "katex" / part).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(katex / part, source / "katex" / part)
    shutil.copytree(katex / "fonts", source / "katex/fonts")
    reference = source / "reference.md"
    reference.write_text(reference.read_text() + tables())
    (source / "validation/figures.md").write_text(figures())
    shutil.rmtree(folder / "overrides", ignore_errors=True)
    shutil.copytree(root / "docs/site/overrides", folder / "overrides")
    subprocess.run(["/usr/bin/mkdocs", "build", "--quiet", "--strict", "--clean"], cwd=folder, check=True)
    write_search_from_disk()
    (site / "404.html").unlink()  # for servers only; its links begin with /
    print(site / "index.html")


if __name__ == "__main__":
    main()
