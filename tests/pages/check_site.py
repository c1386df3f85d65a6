#!/usr/bin/env python3
"""The site of all pages in a browser without a window: it asks for nothing outside, finds words offline, and shows its formulas and pictures.

usage: check_site.py SITE (the folder that ./start docs fills)
"""

import sys
from pathlib import Path

from browser import Browser, find_browser

PAGES = ("index.html", "gallery.html", "theory/nlgs.html", "python_api.html", "fortran/index.html")
# Words, and a page that the search must find by them.
SEARCHES = (("rolling friction", "rolling"), ("transformations", "python"), ("walltime", "guide/"))
SEARCH = """(async () => {
  const field = document.querySelector("input.md-search__input"), pause = () => new Promise(done => setTimeout(done, 100));
  document.getElementById("__search").click();
  await pause();
  field.focus();
  field.value = %r;
  field.dispatchEvent(new InputEvent("input", {bubbles: true}));
  field.dispatchEvent(new KeyboardEvent("keyup", {bubbles: true}));
  for (let k = 0; k < 150; k++) {
    await pause();
    const found = [...document.querySelectorAll(".md-search-result__link")].map(link => link.href);
    if (found.length) return found;
  }
  return [];
})()"""


def mistakes(browser, site):
    """What is wrong with the site, as sentences."""
    found = []
    for name in PAGES:
        for event in browser.open(site / name, 1280):
            what = event.get("params", {})
            if event.get("method") == "Network.requestWillBeSent" and what["request"]["url"].startswith("http"):
                found.append(f"{name} asks for {what['request']['url']}")
            elif event.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
                found.append(f"{name}: {what.get('entry', {}).get('text') or what['exceptionDetails']['text']}")
        lost = browser.value("[...document.images].map(i => (i.loading = 'eager', i)).length")
        lost = lost and browser.value("new Promise(done => setTimeout(() => done([...document.images].filter(i => !i.naturalWidth).map(i => i.src)), 1500))")
        found += [f"{name} does not show {address}" for address in lost or []]
        if name.startswith("theory") and not browser.value("document.querySelectorAll('math').length"):
            found.append(f"{name} has no formula")
    # The site searches once its field has the focus, which a page in no window never has.
    browser.ask("Emulation.setFocusEmulationEnabled", enabled=True)
    browser.open(site / "index.html", 1280)
    for words, part in SEARCHES:
        hits = browser.value(SEARCH % words)
        print(f"{words}: {len(hits)} hits, {hits[0].rpartition('/site/')[2] if hits else 'none'} first")
        if not any(part in hit for hit in hits):
            found.append(f"does not find '{words}' on a page of '{part}'")
        browser.open(site / "index.html", 1280)
    return found


def main(site):
    if find_browser() is None:
        sys.exit("check_site: there is no browser; Debian calls it chromium")
    with Browser() as browser:
        found = mistakes(browser, Path(site).resolve())
    for sentence in found:
        print(f"FAILED: {sentence}")
    print(f"{len(PAGES) + len(SEARCHES)} passed, 0 failed" if not found else f"0 passed, {len(found)} failed")
    return 1 if found else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
