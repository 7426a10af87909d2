"""Checks licences, versions and sources of all crates by deny.toml, as `cargo deny check licenses bans sources` does, in a second.

cargo-deny itself runs in .github/workflows/ci.yml; this is the part that is useful before that. Fails on a key of deny.toml that it does not apply,
so that no rule is left out unseen. Needs tomli for Python 3.10 (requirements-test.lock has it).
"""

import json
import re
import subprocess
import sys
from pathlib import Path

try:
    import tomllib
except ModuleNotFoundError:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
# Keys that are applied; advisories, which need the network, and confidence-threshold, which is about texts, are left to cargo-deny.
KNOWN = {
    "graph": {"all-features"},
    # Keys that only cargo-deny applies.
    "advisories": {"yanked", "ignore"},
    "licenses": {"allow", "confidence-threshold", "exceptions"},
    "bans": {"multiple-versions", "wildcards", "allow-wildcard-paths", "deny", "skip"},
    "sources": {"unknown-registry", "unknown-git", "allow-registry"},
}


def is_allowed(expression, allow):
    """True if an SPDX expression can be satisfied by the licences allowed; `A/B`, as crates once wrote, means either."""
    tokens = re.findall(r"[()]|[^\s()/]+|/", expression)
    at = 0

    def word():
        return tokens[at] if at < len(tokens) else None

    def either():
        nonlocal at
        found = both()
        while word() in ("OR", "/"):
            at += 1
            found = both() or found
        return found

    def both():
        nonlocal at
        found = single()
        while word() == "AND":
            at += 1
            found = single() and found
        return found

    def single():
        nonlocal at
        token = word()
        at += 1
        if token == "(":
            found = either()
            if word() != ")":
                raise ValueError(f"found no `)` in the licence `{expression}`")
            at += 1
            return found
        if token is None or token in (")", "AND", "OR", "WITH", "/"):
            raise ValueError(f"found `{token}` in the licence `{expression}`, expected a licence")
        if word() == "WITH":
            exception = tokens[at + 1] if at + 1 < len(tokens) else ""
            at += 2
            # An exception adds permissions, but is allowed by name only, as by cargo-deny.
            return f"{token} WITH {exception}" in allow
        return token in allow

    found = either()
    if at < len(tokens):
        raise ValueError(f"found `{word()}` in the licence `{expression}`, expected AND or OR")
    return found


def complaints(rules, packages, shipped):
    """A sentence for each rule that a package breaks. Packages as in cargo's metadata; `shipped` are those that not only tests need."""
    for table, keys in rules.items():
        for key in keys:
            if key not in KNOWN.get(table, ()):
                yield f"deny.toml: found [{table}] {key}, which scripts/check_dependencies.py does not apply: teach it"
    bans, sources, allow = rules["bans"], rules["sources"], set(rules["licenses"]["allow"])
    exceptions = {one["crate"]: set(one["allow"]) for one in rules["licenses"].get("exceptions", [])}
    refused = {entry["name"]: entry["reason"] for entry in bans["deny"]}
    versions = {}
    for package in packages:
        name, source = package["name"], package["source"]
        full = f"{name} {package['version']}"
        if name in refused:
            yield f"{full}: is refused: {refused[name]}"
        licence = package["license"]
        try:
            if not licence:
                yield f"{full}: found no licence expression, expected one that deny.toml allows"
            elif not is_allowed(licence, allow | exceptions.get(package["name"], set())):
                yield f"{full}: found the licence `{licence}`, expected one that deny.toml allows"
        except ValueError as error:
            yield f"{full}: {error}"
        if source is not None and source.removeprefix("registry+") not in sources["allow-registry"]:
            yield f"{full}: comes from {source}, expected a registry that deny.toml allows"
        for dependency in package["dependencies"]:
            by_path = dependency.get("path") and bans["allow-wildcard-paths"]
            if bans["wildcards"] == "deny" and dependency["req"] == "*" and not by_path:
                yield f"{full}: takes any version of {dependency['name']}, expected a range"
    skipped = [entry["crate"].split("@") for entry in bans.get("skip", ())]
    for package in shipped:
        if any(package["name"] == name and f"{package['version']}.".startswith(f"{version}.") for name, version in skipped):
            continue
        versions.setdefault(package["name"], set()).add(package["version"])
    if bans["multiple-versions"] == "deny":
        for name, found in sorted(versions.items()):
            if len(found) > 1:
                yield f"{name}: found the versions {', '.join(sorted(found))}, expected one: see `cargo tree -d`"


def reached(metadata, kinds):
    """The packages that those of the workspace depend on by dependencies of these kinds (None: the default ones)."""
    def counts(dependency):
        # `cfg(any())` is true nowhere: such a dependency only ties two versions together.
        return any(kind["kind"] in kinds and kind["target"] != "cfg(any())" for kind in dependency["dep_kinds"])

    nodes = {node["id"]: [it["pkg"] for it in node["deps"] if counts(it)] for node in metadata["resolve"]["nodes"]}
    found, waiting = set(), list(metadata["workspace_members"])
    while waiting:
        package = waiting.pop()
        if package not in found:
            found.add(package)
            waiting += nodes[package]
    return [package for package in metadata["packages"] if package["id"] in found]


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments], cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True).stdout


def in_tree(*arguments):
    """Names and versions of the packages that `cargo tree` shows, on any machine."""
    tree = cargo("tree", "--locked", "--target", "all", "--prefix", "none", "--format", "{p}", *arguments)
    return {tuple(line.split()[:2]) for line in tree.splitlines() if line}


def main():
    rules = tomllib.loads((ROOT / "deny.toml").read_text(encoding="utf-8"))
    metadata = json.loads(cargo("metadata", "--locked", "--all-features", "--format-version", "1"))
    # The metadata contain packages that only a feature of an optional dependency mentions; the tree does not.
    used = in_tree("--workspace", "--all-features")
    sets = []
    # As for cargo-deny, packages that only tests need may be present in a second version, but without other exceptions.
    for kinds in [(None, "build", "dev"), (None, "build")]:
        packages = reached(metadata, kinds)
        sets.append([it for it in packages if (it["name"], f"v{it['version']}") in used])
    found = list(complaints(rules, *sets))
    for complaint in found:
        print(complaint)
    if not found:
        print(f"dependencies: {len(sets[0])} crates, by licences and sources that deny.toml allows, none of them twice")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
