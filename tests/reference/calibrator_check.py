#!/usr/bin/env python3
"""Opens a calibrator page in headless Chromium and compares it with `flow calibrate`.

    pip install playwright          # drives the Chromium that is installed; no browser is downloaded
    python3 calibrator_check.py page.html [--flow "flow calibrate W.toml --store S"] [--targets 200] [--shots FOLDER]

* Predictions and their intervals at the solutions of `flow calibrate --json` are the same to 1e-9.
* The target sets of the page, and random targets that can be had (the responses of random parameters), are met to a misfit
  of 1e-6; a set that cannot be met is as near as that of `flow` to 1e-3.
* The page is one file of at most 300 KB, loads nothing else and is silent; it holds its width at 1280 and 390 pixels, light,
  dark and in print; fields, ranges, holding, keys and copied texts do what they say. Times are printed, not judged.
"""
import argparse
import json
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]
LIMIT = 300_000
faults = []


def check(fine, words):
    print(("ok    " if fine else "FAULT ") + words)
    if not fine:
        faults.append(words)


SOLVE = """(aims) => { const { model } = Calibrator.all[0], began = performance.now();
  const point = model.parameters.map((p) => p.preferred ?? Box.natural(p, 0.5)), held = model.parameters.map((p) => p.held);
  const found = Solve.solve(model, aims, point, held), milliseconds = performance.now() - began;
  model.parameters.forEach((_, i) => Solve.determine(model, found, i));
  return { misfit: found.misfit, point: found.point, values: found.values, free: found.free, milliseconds, full: performance.now() - began }; }"""
PREDICT = """(point) => Calibrator.all[0].model.responses.map((r) => { const { value, interval } = Surface.predict(r, point); return [value, ...interval]; })"""
MODEL = "() => { const { parameters, responses, sets } = Calibrator.all[0].model; return { parameters, sets, responses: responses.map(({ name, unit }) => ({ name, unit })) }; }"


def near(a, b, tolerance):
    return abs(a - b) <= tolerance * max(abs(a), abs(b), 1e-300)


def against_flow(page, model, command, sets):
    """Every set by `flow calibrate --json` and by the page."""
    worst, apart = 0.0, 0.0
    for aims in sets:
        targets = []
        for aim in aims:
            response = model["responses"][aim["response"]]
            targets += ["--target", f"{response['name']}={aim['low']!r} {response['unit']}".strip()]
        answer = json.loads(subprocess.run(shlex.split(command) + ["--json"] + targets, check=True, capture_output=True, text=True).stdout)
        point = [answer["solution"][parameter["name"]] for parameter in model["parameters"]]
        predicted = page.evaluate(PREDICT, point)
        for row in answer["prediction"]:
            index = next(i for i, response in enumerate(model["responses"]) if response["name"] == row["response"])
            for found, wanted in zip(predicted[index], (row["expected"], row["low"], row["high"])):
                if wanted is not None:
                    worst = max(worst, abs(found - wanted) / max(abs(wanted), 1e-300))
        found = page.evaluate(SOLVE, aims)
        theirs = answer["solution"]["misfit"]
        apart = max(apart, found["misfit"] - theirs)
        if theirs <= 1e-6:
            # Both are the solution nearest the middle of the ranges.
            off = lambda x: sum(((v - p["low"]) / (p["high"] - p["low"]) - 0.5) ** 2 for v, p in zip(x, model["parameters"])) ** 0.5
            check(found["misfit"] <= 1e-6, f"a set that flow meets is met: misfit {found['misfit']:.1e}")
            check(off(found["point"]) <= off(point) + 1e-4, f"it is as near the middle: {off(found['point']):.6f} beside {off(point):.6f}")
    check(worst <= 1e-9, f"predictions and intervals are those of flow: largest difference {worst:.1e} over {len(sets)} sets")
    check(apart <= 1e-3, f"what cannot be met is as near: misfit above flow's by {apart:.1e} at most")


def random_targets(page, model, count):
    stream, worst, times = random.Random(7), 0.0, []
    for _ in range(count):
        point = [stream.uniform(p["low"], p["high"]) for p in model["parameters"]]
        aims = [{"response": i, "low": y[0], "high": y[0], "tolerance": None} for i, y in enumerate(page.evaluate(PREDICT, point))]
        found = page.evaluate(SOLVE, aims)
        worst = max(worst, found["misfit"])
        times.append((found["milliseconds"], found["full"]))
    check(worst <= 1e-6, f"{count} random targets are met: largest misfit {worst:.1e}")
    for what, all_times in zip(("solution", "with the range of every parameter"), zip(*times)):
        ordered = sorted(all_times)
        print(f"      {what}: median {ordered[len(ordered) // 2]:.0f} ms, slowest {ordered[-1]:.0f} ms")


def form(page, model):
    knob = page.locator(".knob").first
    field, slide = knob.locator(".value"), knob.locator(".slide")
    parameter = model["parameters"][0]
    shown = page.evaluate("() => [...document.querySelectorAll('.knob')].map((k) => [Number(k.querySelector('.value').value || NaN), k.querySelector('.hold input').checked])")
    wanted = [own["held"] for own in model["parameters"]]
    check(all(number == number for number, _ in shown) and [held for _, held in shown] == wanted, f"every parameter has a number, and is held as the workflow says: {shown}")
    value = lambda: float(field.input_value())
    field.fill(str(parameter["high"] * 10))
    field.press("Tab")
    check(near(value(), parameter["high"], 1e-9) and "ends at" in page.locator(".said").inner_text(), "a value beyond its range is brought to its end, and said")
    inside = 0.5 * (parameter["low"] + parameter["high"])
    field.fill(f"{inside:.4f}".replace(".", ","))
    field.press("Tab")
    check(near(value(), float(f"{inside:.4f}"), 1e-5), f"a decimal comma is read: {value()}")
    field.fill("1,500")
    field.press("Tab")
    said = page.locator(".said").inner_text()
    check("1,500" in said and near(value(), float(f"{inside:.4f}"), 1e-5), f"what may be a separator of thousands is refused, and changes nothing: {said}")
    slide.focus()
    page.keyboard.press("Home")
    check(near(value(), parameter["low"], 1e-9), "the slider moves by keys")
    check(parameter["name"] in slide.get_attribute("aria-valuetext"), "the slider says its value and parameter")
    knob.locator(".hold input").check()
    page.locator(".solve").click()
    check(near(value(), parameter["low"], 1e-9), "what is held stays when parameters are sought")
    knob.locator(".hold input").uncheck()
    page.locator(".solve").click()
    page.wait_for_function("() => document.querySelectorAll('.extent').length === document.querySelectorAll('.knob').length")
    words = page.locator(".extent .word").all_inner_texts()
    check(all(word.split()[0] in ("free", "determined", "partly", "unknown", "held") for word in words), f"every parameter has its word: {words}")
    low = page.locator(".aim .low").first
    before = low.input_value()
    low.fill(str(float(before) * 50))
    low.press("Enter")
    check("out of reach" in page.locator(".verdict").inner_text() and "nearest" in page.locator(".verdict").inner_text(), "a target out of reach is named with the nearest that can be had")
    # Messages call a quantity what the form calls it: by its symbol, not by the name beside that.
    beside = page.evaluate("() => [...document.querySelectorAll('.head .name')].map((e) => e.textContent)")
    said = page.evaluate("""() => ['.verdict', '.said', '.extents', '.mark'].flatMap((what) => [...document.querySelectorAll(what)]).map((e) => {
      const words = e.cloneNode(true);
      words.querySelectorAll('.symbol').forEach((symbol) => symbol.remove());
      return words.textContent;
    }).join(' ')""")
    named = [name for name in beside if re.search(rf"(?<!\w){re.escape(name)}(?!\w)", said)]
    check(page.locator(".verdict .symbol").count() > 0 and not named, f"messages use the symbols of the form {named}")
    low.fill(before)
    low.press("Enter")
    check("All targets are met" in page.locator(".verdict").inner_text(), "and met again")
    page.evaluate("() => { window.copied = []; Object.defineProperty(navigator, 'clipboard', { configurable: true, value: { writeText: async (t) => { window.copied.push(t); } } }); }")
    for button in page.locator(".texts .tools button").all():
        button.click()
    page.wait_for_timeout(100)
    copied = page.evaluate("() => window.copied")
    check(len(copied) == 2 and copied[0].startswith("# Found") and copied[1].startswith("; Found"), "TOML and commands for PFC are copied")
    nameless = page.evaluate("""() => [...document.querySelectorAll('input, select, button')].filter((e) => !e.hidden && !(e.labels?.length || e.ariaLabel || e.textContent.trim())).length""")
    check(nameless == 0, f"every control has a name ({nameless} have none)")


def copied_profile(command, text):
    """The TOML of the page, added to the workflow, is a profile that `flow check` takes."""
    words = shlex.split(command)
    at = words.index("calibrate")
    workflow = Path(words[at + 1])
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=workflow.resolve().parent) as copy:
        copy.write(workflow.read_text() + "\n" + text)
        copy.flush()
        done = subprocess.run(words[:at] + ["check", copy.name, "--profile", "calibrated"], capture_output=True, text=True)
    check(done.returncode == 0, f"the copied TOML is a profile of the workflow {done.stderr[:300]}")


def look(browser, file, width, scheme, shots):
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, has_touch=width < 500)
    page = context.new_page()
    said, asked = [], []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(file.as_uri(), wait_until="load")
    page.wait_for_function("() => document.querySelectorAll('.extent').length === document.querySelectorAll('.knob').length")
    for media in ("screen", "print"):
        page.emulate_media(media=media, color_scheme=scheme)
        wide = page.evaluate("() => [document.documentElement.scrollWidth, innerWidth]")
        check(wide[0] <= wide[1], f"{width} px, {scheme}, {media}: no sideways scrolling ({wide[0]} of {wide[1]} px)")
        if shots:
            shots.mkdir(parents=True, exist_ok=True)
            page.screenshot(path=shots / f"calibrator-{width}-{scheme}-{media}.png", full_page=True)
    page.emulate_media(media="screen", color_scheme=scheme)
    check(not said, f"{width} px, {scheme}: silent console {said[:3]}")
    outside = [url for url in asked if not url.startswith(("file:", "data:"))]
    check(not outside and len([url for url in asked if url.startswith("file:")]) == 1, f"{width} px, {scheme}: nothing is loaded but the file {outside}")
    return context, page


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=Path)
    parser.add_argument("--flow", default="")
    parser.add_argument("--targets", type=int, default=200)
    parser.add_argument("--shots", type=Path)
    arguments = parser.parse_args()
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not found:
        sys.exit("no Chromium is installed")
    file = arguments.page.resolve()
    size = file.stat().st_size
    check(size <= LIMIT, f"{size} bytes, at most {LIMIT}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, headless=True, args=FLAGS)
        for width in (1280, 390):
            for scheme in ("light", "dark"):
                context, page = look(browser, file, width, scheme, arguments.shots)
                if (width, scheme) == (1280, "light"):
                    model = page.evaluate(MODEL)
                    sets = [own["targets"] for own in model["sets"]]
                    random_targets(page, model, arguments.targets)
                    if arguments.flow:
                        beyond = [{**aim, "low": 3 * aim["low"], "high": 3 * aim["high"]} if i == 0 else aim for i, aim in enumerate(sets[0])]
                        against_flow(page, model, arguments.flow, sets + [beyond])
                    form(page, model)
                    if arguments.flow:
                        copied_profile(arguments.flow, page.locator(".toml").inner_text())
                context.close()
        browser.close()
    print(f"{len(faults)} faults")
    sys.exit(bool(faults))


main()
