#!/usr/bin/python3
"""Holds the documents to what talus does.

    use_docs.py commands TALUS   runs every block of commands, each page in a fresh folder
    use_docs.py links            every relative link leads to something that is there
    use_docs.py symptoms         what docs/troubleshooting.md says that talus prints stands in the sources
    use_docs.py site TALUS       the site that is made of them asks for nothing from elsewhere, its links hold, and its search works

Blocks marked sh, console and python are run, page by page, in the order of the page, in a folder that has cases/, validation/ and build/
as the repository has, and `talus` on the path. In console blocks lines that begin with `$ ` are commands and the others what they print,
with `...` for what may be anything. A comment above a block changes this:

    <!-- not run: REASON -->
    <!-- run with: ARGUMENTS -->     appended to every `talus run` without that option, so that it ends soon
    <!-- shortened: THIS -> THAT -->   another word in the commands, for the same reason
    <!-- exits with 2 -->             the last command does, instead of with 0
    <!-- file: NAME -->               the block is written into this file
    <!-- needs: python -->            only where the Python package is built: build/python
"""

import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]
fence = re.compile(r"((?:^<!--.*?-->\n)*)^```(\w*)\n(.*?)^```$", re.M | re.S)


def pages():
    return sorted([root / "README.md", *(root / "docs").rglob("*.md"), *(root / "validation").rglob("README.md"),
                   root / "benchmarks/README.md", root / "CONTRIBUTING.md", root / "CHANGELOG.md"])


def directives(comments):
    found = {"shortened:": []}
    for text in re.findall(r"<!--\s*(.*?)\s*-->", comments):
        name = next((n for n in ("not run:", "run with:", "shortened:", "exits with", "file:", "needs:") if text.startswith(n)), None)
        if name is None:
            raise ValueError(f"<!-- {text} --> is no word to the tests")
        told = text[len(name):].strip()
        found[name] = found[name] + [told] if name == "shortened:" else told
    return found


def shortened(commands, said):
    for this, that in (told.split(" -> ") for told in said["shortened:"]):
        if this not in commands:
            raise ValueError(f"`{this}` is not in the block that it is to shorten")
        commands = commands.replace(this, that)
    if "run with:" in said:
        option = said["run with:"].split()[0]
        commands = re.sub(rf"^((?:\S*/|\$ ?)?talus run (?![^#\n]*{option})[^#\n]*?)([ \t]*(?:#.*)?)$",
                          lambda m: f"{m[1]} {said['run with:']}{m[2]}", commands, flags=re.M)
    return commands


def fits(expected, printed):
    """Whether what was printed is as the page has it; `...` stands for anything, alone on a line for any lines."""
    pattern = ""
    for line in expected.splitlines():
        pattern += r"(?:.*\n)*?" if line.strip() == "..." else re.escape(line).replace(r"\.\.\.", ".*?") + "\n"
    return re.fullmatch(pattern, printed if printed.endswith("\n") or not printed else printed + "\n") is not None


def run_page(page, talus):
    """The complaints about a page, and how many blocks were run."""
    complaints, ran = [], 0
    text = page.read_text()
    with tempfile.TemporaryDirectory(prefix="talus_docs_") as folder:
        for name in ("cases", "validation"):
            os.symlink(root / name, pathlib.Path(folder) / name)
        os.symlink(talus.parent, pathlib.Path(folder) / "build")
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        environment["PATH"] = f"{talus.parent}:{environment['PATH']}"
        environment["PYTHONPATH"] = str(talus.parent / "python")

        def call(command, code):
            done = subprocess.run(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            if done.returncode != code:
                complain(f"ended with {done.returncode}, not {code}:\n{done.stdout}")
            return done.stdout

        for block in fence.finditer(text):
            line = text.count("\n", 0, block.start(2)) + 1

            def complain(what):
                complaints.append(f"{page.relative_to(root)}:{line}: {what}")

            try:
                said, language, code = directives(block[1]), block[2], block[3]
                expected_code = int(said.get("exits with", 0))
                if "not run:" in said or ("needs:" in said and not (talus.parent / said["needs:"]).exists()):
                    continue
                if "file:" in said:
                    (pathlib.Path(folder) / said["file:"]).write_text(code)
                    continue
                if language == "sh":
                    call(["bash", "-e", "-c", shortened(code, said)], expected_code)
                elif language == "python":
                    call(["/usr/bin/python3", "-c", shortened(code, said)], expected_code)
                elif language == "console":
                    parts = re.split(r"^\$ (.*)\n", shortened(code, said), flags=re.M)
                    for i in range(1, len(parts), 2):
                        last = i + 2 >= len(parts)
                        printed = call(["bash", "-c", parts[i]], expected_code if last else 0)
                        if not fits(parts[i + 1], printed):
                            complain(f"`{parts[i]}` prints something else:\n{printed}")
                else:
                    continue
                ran += 1
            except ValueError as e:
                complain(str(e))
    return complaints, ran


def commands(talus):
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda page: run_page(page, talus), pages()))
    print(f"{sum(ran for _, ran in results)} blocks run")
    return [c for complaints, _ in results for c in complaints]


def slug(heading):
    """The anchor of a heading, as GitHub and MkDocs make it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
    return re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", text).strip().lower())


def links():
    complaints = []
    for page in pages():
        text = re.sub(r"^```.*?^```$|`[^`\n]*`|\$\$.*?\$\$|\$[^$]*\$", lambda m: "\n" * m[0].count("\n"), page.read_text(),
                      flags=re.M | re.S)  # neither code nor formulas
        for found in re.finditer(r"\[[^\]]*\]\(([^)\s]+)\)", text):
            target, _, anchor = found[1].partition("#")
            if re.match(r"[a-z]+:", target):
                continue
            where = f"{page.relative_to(root)}:{text.count(chr(10), 0, found.start()) + 1}: {found[1]}"
            path = pathlib.Path(os.path.normpath(page.parent / target)) if target else page
            if not path.exists():
                complaints.append(f"{where} leads nowhere")
            elif anchor and path.suffix == ".md":
                anchors = [slug(h) for h in re.findall(r"^#+ (.*)$", path.read_text(), flags=re.M)]
                if anchor not in anchors:
                    complaints.append(f"{where}: there is no such heading")
    return complaints


def symptoms():
    """Headings with code are what talus prints, `…` for names and numbers: each part must stand in a text of the sources."""
    sources = "\n".join(p.read_text() for p in (root / "src/talus").rglob("*.[ch]pp"))
    sources = re.sub(r'"\s*\n\s*"', "", sources)  # texts that go on in the next line
    sources = sources.replace('\\"', '"')
    complaints, page = [], root / "docs/troubleshooting.md"
    told = re.findall(r"^### `(.*)`$", page.read_text(), flags=re.M)
    if len(told) < 20:
        complaints.append(f"{page.name} has {len(told)} symptoms; the test no longer finds them")
    for symptom in told:
        for part in re.split(r"\s*…\s*", symptom):
            if part and part not in sources:
                complaints.append(f"docs/troubleshooting.md: no source prints `{part}` (of `{symptom}`)")
    return complaints


def site(talus):
    with tempfile.TemporaryDirectory(prefix="talus_site_") as folder:
        subprocess.run([root / "scripts/site.py", talus, folder], check=True, stdout=subprocess.DEVNULL)
        return faults_of_site(pathlib.Path(folder) / "site") + faults_of_search(pathlib.Path(folder) / "site")


def faults_of_search(folder):
    """Searches a page read from the disk, as a reader does."""
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait
    from selenium.common.exceptions import TimeoutException

    sys.path.insert(0, str(root / "tests"))
    from browser import chromium

    driver = chromium("--window-size=1400,1000")
    try:
        driver.get((folder / "howto/own_column.html").as_uri())
        query = driver.find_element(By.CSS_SELECTOR, "[data-md-component=search-query]")
        query.click()
        query.send_keys("no_slip")

        def found(_):
            links = driver.find_elements(By.CSS_SELECTOR, ".md-search-result__link")
            return [link.get_attribute("href") for link in links]

        try:
            links = WebDriverWait(driver, 20).until(found)
        except TimeoutException:
            return ["a search on a page from the disk finds nothing"]
        return [] if any("walls.html" in link for link in links) else [f"a search for no_slip does not find walls.html, but {links}"]
    finally:
        driver.quit()


def faults_of_site(folder):
    """Scripts, styles, fonts and pictures that a page would fetch from elsewhere, and links that lead nowhere."""
    complaints = []
    files = [p for p in folder.rglob("*") if p.suffix in (".html", ".css")]
    if not (folder / "index.html").exists():
        complaints.append(f"{folder} holds no index.html")
    fetched = re.compile(r"""<(?:script|img|iframe|source|video|audio)\b[^>]*?\bsrc=["']?((?:https?:)?//[^"'\s>]+)
                           |<link\b(?=[^>]*\brel=["']?(?:stylesheet|preload|preconnect|icon|prefetch))[^>]*?\bhref=["']?((?:https?:)?//[^"'\s>]+)
                           |(?:@import\s+|url\()\s*["']?((?:https?:)?//[^"')\s]+)""", re.X | re.I)
    for page in files:
        for found in fetched.finditer(page.read_text(errors="replace")):
            complaints.append(f"{page.relative_to(folder)} fetches {found[1] or found[2] or found[3]}")
    for page in files:
        if page.suffix != ".html" or "reproduced" in page.parts:
            continue
        for target in re.findall(r"""<(?:a|link|img|script)\b[^>]*?\b(?:href|src)=["']?([^"'\s>#]+)""", page.read_text()):
            if not re.match(r"[a-z]+:|//", target) and not (page.parent / target).exists():
                complaints.append(f"{page.relative_to(folder)}: {target} leads nowhere")
    return complaints


if __name__ == "__main__":
    what, given = sys.argv[1], [pathlib.Path(a).resolve() for a in sys.argv[2:]]
    wrong = {"commands": commands, "links": links, "symptoms": symptoms, "site": site}[what](*given)
    print("\n".join(wrong))
    sys.exit(bool(wrong))
