#!/usr/bin/env python3
"""Checks the links of README.md and the book without network: python3 .ci/links.py [FOLDER]

A link must lead to a file or folder that is there, and a #anchor to a heading of that page. Pages of the
book link to nothing outside docs/, as the built book would not have it, and each one is in SUMMARY.md.
Exit code 1 and a line for each dead link.
"""

import re
import sys
from pathlib import Path

FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)


def prose(page):
    return FENCE.sub("", page.read_text(encoding="utf-8"))


def anchors(page):
    """Names of headings, as GitHub and mdBook make them; the second of a name is not linked to."""
    names = (heading.replace("`", "").strip().lower() for heading in HEADING.findall(prose(page)))
    return {re.sub(r"[^\w\- ]", "", name).replace(" ", "-") for name in names}


def faults(page, book):
    """What is wrong with the links of one page."""
    text = CODE.sub(lambda code: " " * len(code[0]), prose(page))
    for target in LINK.findall(text):
        if re.match(r"\w+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            yield f"{target}: no such file"
        elif page.parent == book and book not in [file, *file.parents]:
            yield f"{target}: not in the book; name the path without a link"
        elif anchor and anchor not in anchors(file):
            yield f"{target}: no such heading"


def main(root):
    book = root / "docs"
    listed = (book / "SUMMARY.md").read_text(encoding="utf-8")
    found = []
    pages = [root / "README.md", *sorted(book.glob("*.md"))]
    for page in pages:
        name = page.relative_to(root).as_posix()
        found += [f"{name}: {fault}" for fault in faults(page, book)]
        if page.parent == book and page.name != "SUMMARY.md" and f"({page.name})" not in listed:
            found.append(f"{name}: not in SUMMARY.md")
    if found:
        sys.exit("\n".join(found))
    print(f"all links of {len(pages)} pages lead somewhere")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve())
