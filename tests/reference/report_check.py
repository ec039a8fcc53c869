#!/usr/bin/env python3
"""Opens a report in headless Chromium and checks what a reader relies on.

    pip install playwright          # drives the Chromium that is installed; no browser is downloaded
    python3 report_check.py report.html [--shots FOLDER] [--seconds 2]

At 1280 and 390 pixels, light and dark: nothing is written to the console, nothing is loaded but the file, the page does
not scroll sideways, texts have a contrast of 4.5. Sorting, copying, enlarging, the theme switch and the values under the
pointer and the arrow keys work; headings are in order, tables have captions and scopes, pictures have words.
"""
import argparse
import shutil
import sys
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]

# Contrast of every text that is seen against the ground behind it (WCAG 2).
CONTRAST = r"""() => {
  const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const rgba = (color) => {
    canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = color; canvas.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data; return [r, g, b, a / 255];
  };
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255).map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (element) => {
    for (let e = element; e; e = e.parentElement) { const c = rgba(getComputedStyle(e).backgroundColor); if (c[3] > 0.99) return c; }
    return [255, 255, 255, 1];
  };
  const bad = new Map();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const e = node.parentElement;
    if (!node.textContent.trim() || e.closest("svg, script, style, dialog:not([open])") || !e.getClientRects().length) continue;
    const a = light(rgba(getComputedStyle(e).color)), b = light(ground(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) bad.set(e.tagName + "." + e.className, ratio.toFixed(2) + " " + node.textContent.trim().slice(0, 30));
  }
  return [...bad].map(([k, v]) => k + ": " + v);
}"""

STRUCTURE = r"""() => {
  const faults = [];
  const all = (what) => [...document.querySelectorAll(what)];
  if (all("h1").length !== 1) faults.push("not one h1");
  let level = 1;
  for (const h of all("main h2, main h3, main h4")) {
    const own = Number(h.tagName[1]);
    if (own > level + 1) faults.push("heading skips a level: " + h.textContent);
    level = own;
  }
  for (const what of ["header", "nav[aria-label]", "main", "footer", "a.skip[href='#main']"]) if (all(what).length !== 1) faults.push("not one " + what);
  for (const t of all("table")) {
    if (!t.caption || !t.caption.textContent.trim()) faults.push("a table without caption");
    if (t.querySelector("thead th:not([scope=col]), tbody th:not([scope=row])")) faults.push("a head without scope in " + t.caption.textContent);
  }
  for (const s of all("figure svg[role=img]")) if (!(s.getAttribute("aria-label") ?? "").trim()) faults.push("a picture without words");
  for (const i of all("img")) if (!i.alt) faults.push("an image without words");
  for (const b of all("button")) if (!b.textContent.trim()) faults.push("a button without a name");
  const ids = all("[id]").map((e) => e.id);
  const twice = ids.filter((id, i) => ids.indexOf(id) !== i);
  if (twice.length) faults.push("ids that stand twice: " + [...new Set(twice)].join(" "));
  for (const a of all("a[href^='#']")) if (!document.getElementById(a.getAttribute("href").slice(1))) faults.push("a link to nothing: " + a.href);
  for (const e of all("[onclick], [onload], [onerror], [style]")) if (e.closest("dialog") === null) faults.push("inline code in " + e.tagName);
  return faults;
}"""

faults = []


def check(fine, words):
    print(("ok    " if fine else "FAULT ") + words)
    if not fine:
        faults.append(words)


def look(browser, page_file, width, height, scheme, arguments):
    """One width and one theme: load, console, network, overflow, contrast."""
    where = f"{width} px, {scheme}"
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme,
                                  device_scale_factor=2 if width < 500 else 1, has_touch=width < 500)
    page = context.new_page()
    said, asked = [], []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    metrics = context.new_cdp_session(page)
    metrics.send("Performance.enable", {"timeDomain": "threadTicks"})
    began = time.perf_counter()
    page.goto(page_file.as_uri(), wait_until="load")
    # Until the first frame after loading is on the screen.
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    seconds = time.perf_counter() - began
    times = page.evaluate("() => { const n = performance.getEntriesByType('navigation')[0]; const p = performance.getEntriesByName('first-contentful-paint')[0];"
                          " return [n.loadEventEnd, p ? p.startTime : -1]; }")
    print(f"      {where}: on the screen after {seconds:.2f} s (load event {times[0] / 1000:.2f} s, first paint {times[1] / 1000:.2f} s)")
    # Other programs may share the machine, so the work that opening takes is judged, not the wait.
    work = {entry["name"]: entry["value"] for entry in metrics.send("Performance.getMetrics")["metrics"]}["TaskDuration"]
    check(work <= arguments.seconds, f"{where}: opens with {work:.2f} s of work, at most {arguments.seconds} s")
    page.evaluate("() => document.querySelectorAll('main details').forEach((d) => { d.open = true; })")
    page.evaluate("async () => { for (let y = 0; y < document.body.scrollHeight; y += 900) { scrollTo(0, y);"
                  " await new Promise(requestAnimationFrame); } scrollTo(0, 0); }")
    wide = page.evaluate("() => [document.documentElement.scrollWidth, innerWidth]")
    check(wide[0] <= wide[1], f"{where}: no sideways scrolling ({wide[0]} of {wide[1]} px)")
    low = page.evaluate(CONTRAST)
    check(not low, f"{where}: contrast of texts" + "".join(f"\n        {line}" for line in low[:12]))
    page.evaluate("() => document.querySelectorAll('main details').forEach((d) => { d.open = false; })")
    outside = [url for url in asked if not url.startswith(("file:", "data:"))]
    check(not outside and len([u for u in asked if u.startswith("file:")]) == 1, f"{where}: nothing is loaded but the file {outside}")
    check(not said, f"{where}: silent console {said[:5]}")
    return context, page


def shots(page, folder, name):
    """Pictures of the page from top to bottom, for people to look at."""
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
        # What is out of sight is not drawn otherwise.
        page.evaluate("() => document.querySelectorAll('section.stage').forEach((s) => { s.style.contentVisibility = 'visible'; })")
        page.screenshot(path=folder / f"{name}.png", full_page=True)


def tables(page):
    sheet = page.locator(".stage .sheet:visible, .printed .sheet:visible").first
    head = sheet.locator("thead th").nth(0)
    column = lambda: sheet.locator("tbody tr > :nth-child(1)").all_inner_texts()
    head.locator("button").click()
    first = column()
    check(head.get_attribute("aria-sort") == "ascending", "sorting says so: ascending")
    head.locator("button").press("Enter")
    check(head.get_attribute("aria-sort") == "descending", "sorting by key says so: descending")
    check(sorted(first) == sorted(column()) and (len(set(first)) < 2 or first != column()), "sorting orders the rows")
    # Numbers sort by their values.
    numbers = page.evaluate(r"""() => {
      const values = (t, k) => [...t.tBodies[0].rows].map((r) => r.children[k].dataset.v ?? r.children[k].textContent.replaceAll("−", "-")).filter((v) => v !== "").map(Number);
      for (const t of document.querySelectorAll(".sheet table")) {
        const heads = [...t.querySelectorAll("thead th")];
        const k = heads.findIndex((th, i) => { const v = values(t, i); return v.length > 3 && new Set(v).size > 3 && v.every(Number.isFinite); });
        if (k < 0) continue;
        heads[k].querySelector("button").click();
        const v = values(t, k);
        return v.every((x, i) => i === 0 || x >= v[i - 1]);
      }
      return null;
    }""")
    check(numbers is True, "numbers are sorted as numbers")
    page.evaluate("() => { window.copied = []; Object.defineProperty(navigator, 'clipboard', { configurable: true, value: { writeText: async (t) => { window.copied.push(t); } } }); }")
    tools = page.locator(".sheet + .tools").first
    tools.get_by_role("button", name="Copy", exact=True).click()
    tools.get_by_role("button", name="Copy as CSV").click()
    page.wait_for_timeout(100)
    copied = page.evaluate("() => window.copied")
    rows = page.locator(".sheet").first.locator("tr").count()
    check(len(copied) == 2 and "\t" in copied[0] and "," in copied[1], "tables are copied as TSV and CSV")
    check(len(copied) == 2 and all(len(text.strip("\n").split("\n")) == rows for text in copied), "all rows are copied")
    check(tools.locator("output").inner_text() == "copied", "copying says so")


def figures(page, folder):
    plots = page.locator("figure:has(script.values) .plot")
    count = plots.count()
    told = 0
    for i in range(count):
        plot = plots.nth(i)
        plot.scroll_into_view_if_needed()
        page.wait_for_timeout(30)
        readout = plot.locator("xpath=following-sibling::output[1]")
        plot.focus()
        page.keyboard.press("ArrowRight")
        by_key = readout.inner_text()
        page.keyboard.press("Shift+ArrowRight")
        moved = readout.inner_text()
        panel = plot.locator("svg g[data-x], svg g[data-space]").first
        box = panel.bounding_box()
        by_pointer = ""
        # Points lie where they lie: try a net of places.
        for share in [(0.5, 0.5), (0.3, 0.3), (0.7, 0.7), (0.3, 0.7), (0.7, 0.3), (0.2, 0.5), (0.8, 0.5), (0.5, 0.2), (0.5, 0.8)]:
            page.mouse.move(box["x"] + share[0] * box["width"], box["y"] + share[1] * box["height"])
            by_pointer = readout.inner_text()
            if by_pointer:
                break
        name = plot.locator("xpath=following-sibling::figcaption/b").inner_text()
        fine = bool(by_key) and bool(by_pointer) and "NaN" not in by_key + by_pointer and "undefined" not in by_key + by_pointer
        told += fine
        if not fine:
            check(False, f"values of {name}: by key {by_key!r}, by pointer {by_pointer!r}")
        elif i < 4 or moved == by_key:
            print(f"      {name}: {by_pointer}")
        if folder and i == 0:
            plot.screenshot(path=folder / "values.png")
        page.mouse.move(2, 2)
    check(count > 0 and told == count, f"values under the pointer and the arrow keys: {told} of {count} figures")
    figure = page.locator("figure:has(script.values)").first
    figure.get_by_role("button", name="Enlarge").click()
    dialog = page.locator("dialog#zoom")
    check(dialog.evaluate("(d) => d.open"), "enlarging opens a dialog")
    box = dialog.locator(".plot > svg").bounding_box()
    dialog.get_by_role("button", name="Larger").click()
    larger = dialog.locator(".plot > svg").bounding_box()
    check(larger["width"] > 1.3 * box["width"], f"the picture grows ({box['width']:.0f} to {larger['width']:.0f} px)")
    if folder:
        dialog.get_by_role("button", name="Fit the window").click()
        page.screenshot(path=folder / "zoom.png")
    page.keyboard.press("Escape")
    check(not dialog.evaluate("(d) => d.open"), "Escape closes it")
    figure.locator(".plot").click()
    check(dialog.evaluate("(d) => d.open"), "a click on the picture opens it")
    dialog.get_by_role("button", name="Close").click()


def theme(page):
    button = page.locator("#tools button")
    ground = lambda: page.evaluate("() => getComputedStyle(document.body).backgroundColor")
    seen = {}
    for _ in range(3):
        seen[button.inner_text()] = ground()
        button.click()
    check(len(seen) == 3 and seen["Theme: light"] != seen["Theme: dark"], "the switch changes the theme")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("report", type=Path)
    parser.add_argument("--shots", type=Path)
    parser.add_argument("--seconds", type=float, default=2.0)
    arguments = parser.parse_args()
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not found:
        sys.exit("no Chromium is installed")
    page_file = arguments.report.resolve()
    print(f"{page_file.name}: {page_file.stat().st_size / 1e6:.2f} MB")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, headless=True, args=FLAGS)
        # The first page of a browser also starts its processes.
        browser.new_page().close()
        for width, height, scheme in [(1280, 900, "light"), (1280, 900, "dark"), (390, 844, "light"), (390, 844, "dark")]:
            context, page = look(browser, page_file, width, height, scheme, arguments)
            if scheme == "light":
                for line in page.evaluate(STRUCTURE):
                    check(False, f"{width} px: {line}")
                check(True, f"{width} px: headings, landmarks, captions, ids and links are looked at")
            shots(page, arguments.shots, f"{width}-{scheme}")
            if width == 1280 and scheme == "light":
                theme(page)
                tables(page)
                figures(page, arguments.shots)
                page.emulate_media(media="print")
                wide = page.evaluate("() => [document.documentElement.scrollWidth, innerWidth]")
                check(wide[0] <= wide[1], "print: no sideways scrolling")
            context.close()
        browser.close()
    print(f"{len(faults)} faults")
    sys.exit(bool(faults))


main()
