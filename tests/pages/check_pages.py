#!/usr/bin/env python3
"""Look at pages of studies and of runs in a browser without a window: offline, at 1280 and 400 pixels.

usage: check_pages.py FOLDER PAGE...

Each page must say nothing to the console, ask for nothing but itself, show all its pictures, keep its text readable, and not be wider than
the window; pictures of it go to FOLDER.
"""

import sys
from pathlib import Path

from browser import Browser, find_browser

WIDTHS = (1280, 400)
# Smallest letters that can be read [px].
SMALLEST = 12

# A click on the first entry of a legend hides its line in all figures, and one more shows it.
CLICK = """(() => {
  const entry = document.querySelector('g[id*="-entry"]');
  if (!entry) return null;
  const lines = [...document.querySelectorAll(`g[id$="-series${entry.id.split('-entry')[1]}"]`)];
  const hidden = () => lines.filter(line => getComputedStyle(line).display === 'none').length;
  const counts = [hidden()];
  for (let k = 0; k < 2; k++) { entry.dispatchEvent(new MouseEvent('click', {bubbles: true})); counts.push(hidden()); }
  return [lines.length, ...counts];
})()"""

LOOK = """(() => {
  document.querySelectorAll('details').forEach(part => { part.open = true; });
  const letters = [...document.querySelectorAll('body *')].filter(part => [...part.childNodes].some(n => n.nodeType == 3 && n.data.trim()));
  const right = part => Math.round(part.getBoundingClientRect().right);
  const scrolls = part => part.closest('.wide') !== null;
  return {
    drawings: [...document.querySelectorAll('figure svg')].filter(part => part.getBoundingClientRect().width >= 250).length,
    scene: typeof window.lookAt === 'function', width: document.documentElement.scrollWidth, inner: innerWidth, title: document.title, height: document.documentElement.scrollHeight,
    pictures: [...document.images].map(i => [i.complete && i.naturalWidth > 0, i.alt]),
    narrow: [...document.images].filter(i => i.getBoundingClientRect().width < 250).map(i => i.alt),
    small: letters.filter(part => parseFloat(getComputedStyle(part).fontSize) < %d).map(part => part.textContent.slice(0, 40)),
    cut: [...document.querySelectorAll('figure svg')].flatMap(svg => { const frame = svg.getBoundingClientRect();
      return [...svg.querySelectorAll('g[id*="text_"], g[id*="legend_"]')].map(part => part.getBoundingClientRect())
        .filter(p => p.width && (p.left < frame.left - 2 || p.right > frame.right + 2 || p.top < frame.top - 2 || p.bottom > frame.bottom + 2))
        .map(p => svg.getAttribute('aria-label')); }),
    out: [...document.querySelectorAll('body *')].filter(p => !scrolls(p) && right(p) > innerWidth).map(p => p.tagName + ' to ' + right(p)),
  };
})()""" % SMALLEST


# A page on which everything is wrong, and what must be noticed.
SPOILED = Path(__file__).with_name("spoiled.html")
IN_SPOILED = ("a script fails", "says to the console", "the console shows", "asks for http://127.0.0.1:9/style.css", "has no title",
              "scrolls sideways", "reaches out", "'absent' is not shown", "letters below", "texts reach out", "by the legend")  # fmt: skip


def mistakes_of(page, browser, width, picture):
    """What is wrong with a page at a width, as sentences."""
    events = browser.open(page, width)
    seen = browser.value(LOOK)
    browser.picture(picture)
    found = []
    for event in events:
        said, what = event.get("method"), event.get("params", {})
        if said == "Runtime.exceptionThrown":
            found.append(f"a script fails: {what['exceptionDetails']['text']}")
        elif said == "Runtime.consoleAPICalled":
            found.append(f"says to the console: {what['args'][:1]}")
        elif said == "Log.entryAdded":
            found.append(f"the console shows: {what['entry']['text']}")
        elif said == "Network.requestWillBeSent" and not what["request"]["url"].startswith(("data:", page.resolve().as_uri())):
            found.append(f"asks for {what['request']['url']}")
    if not seen["title"]:
        found.append("has no title")
    if seen["width"] > width or seen["inner"] != width:
        found.append(f"is {seen['width']} pixels wide: it scrolls sideways")
    found += [f"reaches out of the window: {part}" for part in seen["out"][:5]]
    found += [f"the picture '{alt}' is not shown" for is_shown, alt in seen["pictures"] if not is_shown]
    found += [f"the picture '{alt}' is too narrow to be read" for alt in seen["narrow"]]
    found += [f"letters below {SMALLEST} pixels: {text}" for text in seen["small"][:5]]
    found += [f"texts reach out of the drawing '{words}'" for words in dict.fromkeys(seen["cut"])]
    clicked = browser.value(CLICK)
    if clicked and (clicked[0] == 0 or clicked[1:] != [0, clicked[0], 0]):
        found.append(f"does not show and hide lines by the legend: {clicked}")
    if seen["scene"]:
        found += mistakes_of_scene(browser)
    elif page.name != "index.html" and not seen["pictures"] and not seen["drawings"]:
        found.append("has no picture")
    print(f"{page.parent.name}/{page.name} at {width}: {seen['height']} pixels high, {len(seen['pictures'])} pictures; {picture}")
    return found


def mistakes_of_scene(browser):
    """What is wrong with the view of a run: it must be drawn, and the pictures must differ."""
    first, last = (browser.value(f"window.lookAt({number})") for number in ("0", "1e9"))
    if first is None:
        return ["has no WebGL 2"]
    found = [f"WebGL reports error {seen['error']}" for seen in (first, last) if seen["error"]]
    found += [f"bodies cover {100 * seen['covered']:.1f} % of the view" for seen in (first, last)
              if seen["grains"] and not 0.01 < seen["covered"] < 0.97]  # fmt: skip
    if first["pictures"] > 1 and first["sum"] == last["sum"]:
        found.append("shows the same in all pictures")
    browser.value("document.getElementById('slider').value = 0, document.getElementById('slider').oninput({target: {value: '0'}}), 1")
    if browser.value("window.lookAt(0)")["sum"] != first["sum"]:
        found.append("shows another first picture after the slider")
    return found + mistakes_of_presence(browser) + mistakes_of_cell(browser) + mistakes_of_mouse(browser)


def mistakes_of_presence(browser):
    """What is wrong with bodies that enter and leave: those that are absent must not be drawn, and the others are those of the record."""
    if not browser.value("data.present !== null"):
        return []
    found = []
    for number in browser.value("data.present.flatMap((row, k) => row.includes(0) ? [k] : [])"):
        shown = browser.value(f"window.lookAt({number})")
        kept = browser.value(f"(kept = data.present, data.present = null, one = window.lookAt({number}), data.present = kept, one)")
        if kept["sum"] == shown["sum"]:
            found.append(f"draws bodies that are absent in picture {number}")
    # A column that does not change is left out of the page: then nothing was removed, or all grains were there from the start.
    present, entered, removed, seen = browser.value("[window.lookAt(0).grains, ...['entered', 'removed'].map(name => (data.record[name] || [0]).at(-1)),"
                                                    " window.lookAt(1e9).grains]")  # fmt: skip
    if seen != present + entered - removed:
        found.append(f"shows {seen} grains at the end; {present} were there, {entered} entered and {removed} were removed")
    return found


def mistakes_of_cell(browser):
    """What is wrong with the cell of a plane scene: images fill its rim as its inside, to the compactness of the record, and none is beyond."""
    if not browser.value("box !== null && !data.in_space && box.periodic[1] > 0"):
        return []
    seen, compactness = browser.value("[window.lookAt(1e9), data.record.compactness.at(-1)]")
    found = []
    # Pixels are counted whole: on 400 pixels a disk of the test is 4 pixels wide.
    if abs(seen["within"] - compactness) > 0.06:
        found.append(f"covers {seen['within']:.3f} of the cell; the compactness is {compactness:.3f}")
    if abs(seen["rim"] - seen["within"]) > 0.09:
        found.append(f"covers {seen['rim']:.3f} of the rim of the cell and {seen['within']:.3f} of its inside")
    if seen["beyond"] > 0.01:
        found.append(f"covers {seen['beyond']:.3f} of what is beyond the cell")
    return found


def mistakes_of_mouse(browser):
    """What is wrong with dragging and the wheel: a scene in space turns, one in the plane moves as the mouse does, both come nearer."""
    x, y, in_space = browser.value("(r => [r.left + r.width / 2, r.top + r.height / 2, data.in_space])(canvas.getBoundingClientRect())")
    start = browser.value("window.lookAt(1e9)")["sum"]
    browser.drag(x, y, x + 40, y + 20)
    turned = browser.value("[window.lookAt(1e9).sum, camera.position.x, camera.position.y, ...controls.target.toArray()]")
    found = [] if turned[0] != start else ["shows the same after the mouse was dragged"]
    if in_space and any(turned[3:]):
        found.append("does not turn about the middle")
    # In the plane the point under the mouse stays there.
    width = browser.value("(camera.right - camera.left) / canvas.clientWidth")
    if not in_space and max(abs(turned[1] + 40 * width), abs(turned[2] - 20 * width)) > 1e-6 * width * 40:
        found.append(f"moves by {turned[1] / width:.2f} and {turned[2] / width:.2f} pixels")
    browser.wheel(x, y, -120)
    if not browser.value("camera.zoom") > 1 or browser.value("window.lookAt(1e9)")["sum"] == turned[0]:
        found.append("does not come nearer with the wheel")
    return found


def main(folder, *pages):
    if find_browser() is None:
        sys.exit("check_pages: there is no browser; Debian calls it chromium")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    passed, failed = 0, 0
    with Browser() as browser:
        found = " ".join(mistakes_of(SPOILED, browser, WIDTHS[0], folder / "spoiled.png"))
        for part in IN_SPOILED:
            if part not in found:
                sys.exit(f"check_pages: does not notice what is wrong with {SPOILED.name}: {part}")
        for page in map(Path, pages):
            for width in WIDTHS:
                found = mistakes_of(page, browser, width, folder / f"{page.parent.name}-{width}.png")
                for sentence in found:
                    print(f"FAILED: {page} at {width} pixels {sentence}")
                passed, failed = passed + (not found), failed + bool(found)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
