// The form: fields and sliders, what they say, and what follows from a change.
const Calibrator = (() => {
  const { make, all, copier } = Page;
  const shown = Charts.shown;
  const withUnit = (text, unit) => unit ? text + " " + unit : text;

  // A number as people type it: a comma may be the decimal sign, but before three digits it may part thousands.
  const read = (field) => {
    const text = field.value.trim();
    const commas = text.split(",").length - 1, thousands = /,\d{3}(?!\d)/.test(text);
    const x = text === "" || commas > 1 || thousands || (commas && text.includes(".")) ? NaN : Number(text.replace(",", "."));
    field.setAttribute("aria-invalid", String(text !== "" && !Number.isFinite(x)));
    return x;
  };
  const refused = (field) => `“${field.value.trim()}” is not read as a number: write it with a decimal point and without separators.`;

  const start = (root) => {
    const model = JSON.parse(root.querySelector(".instrument").textContent);
    const find = (what) => root.querySelector(what);
    const knobs = all(".knob", root), aimRows = all(".aim", root), cards = all(".card", root);
    const state = { point: [], held: [], found: null, other: -1, reaches: [] };
    const { parameters, responses } = model;
    const heads = { parameter: (i) => knobs[i].querySelector(".head"), response: (k) => aimRows[k].querySelector(".head") };
    const label = (head, unit) => {
      const all = make("span", {}, ...[...head.childNodes].map((node) => node.cloneNode(true)));
      if (unit) all.append(" (" + unit + ")");
      return all;
    };
    const labels = { parameter: (i) => label(heads.parameter(i), parameters[i].unit), response: (k) => label(heads.response(k), responses[k].unit) };
    // Messages are lists of words and symbols, so that a quantity is called everywhere what it is called in the form.
    const sign = { parameter: (i) => heads.parameter(i).querySelector(".symbol").cloneNode(true), response: (k) => heads.response(k).querySelector(".symbol").cloneNode(true) };
    const joined = (lists, between) => lists.flatMap((list, n) => n ? [between, ...list] : list);

    // Targets.
    const readAim = (row, response) => {
      const mode = row.querySelector(".mode").value;
      const low = read(row.querySelector(".low")), high = read(row.querySelector(".high"));
      const tolerance = state.tolerances?.[response] ?? null;
      if (mode === "between") return Number.isFinite(low) || Number.isFinite(high) ? { response, low: Number.isFinite(low) ? low : -Infinity, high: Number.isFinite(high) ? high : Infinity, tolerance } : null;
      if (!Number.isFinite(low)) return null;
      return { response, low: mode === "at-most" ? -Infinity : low, high: mode === "at-least" ? Infinity : low, tolerance };
    };
    const aims = () => aimRows.map(readAim).filter(Boolean);
    const faultOf = (list) => {
      if (!list.length) return ["Give at least one target."];
      const empty = list.find(({ low, high }) => low > high);
      if (empty) return [sign.response(empty.response), ": the band is empty, its lower end is above its upper one."];
      const zero = list.find(({ low, high }) => model.denominator !== "largest" && (low === 0 || high === 0));
      return zero ? [sign.response(zero.response), ": a target of 0 has no relative deviation."] : null;
    };
    const writeSet = (set) => {
      state.tolerances = Object.create(null); // a response may be called `constructor`
      aimRows.forEach((row, response) => {
        const aim = set.targets.find((own) => own.response === response);
        const mode = !aim || aim.low === aim.high ? "exactly" : aim.high === null ? "at-least" : aim.low === null ? "at-most" : "between";
        row.querySelector(".mode").value = mode;
        row.querySelector(".low").value = aim ? Texts.plain(mode === "at-most" ? aim.high : aim.low) : "";
        row.querySelector(".high").value = mode === "between" ? Texts.plain(aim.high) : "";
        if (aim) state.tolerances[response] = aim.tolerance;
        fitMode(row);
      });
      parameters.forEach((parameter, i) => { if (Object.hasOwn(set.held, parameter.name)) { state.point[i] = set.held[parameter.name]; state.held[i] = true; } });
    };
    const fitMode = (row) => { row.querySelector(".high").hidden = row.querySelector(".mode").value !== "between"; };

    // Parameters.
    const showKnobs = () => knobs.forEach((knob, i) => {
      const { unit, name } = parameters[i], slide = knob.querySelector(".slide"), field = knob.querySelector(".value");
      slide.value = Box.unit(parameters[i], state.point[i]);
      slide.setAttribute("aria-valuetext", withUnit(shown(state.point[i]), unit) + ", " + name);
      if (document.activeElement !== field) field.value = Number(state.point[i].toPrecision(6));
      knob.querySelector(".hold input").checked = state.held[i];
    });
    const enforce = (i, x) => {
      const { low, high, unit } = parameters[i];
      const fit = Math.min(Math.max(x, low), high);
      find(".said").replaceChildren(...fit === x ? [] : [sign.parameter(i), ` ends at ${withUnit(shown(fit), unit)}: beyond it nothing was run.`]);
      return fit;
    };

    // What is predicted.
    const showCards = () => cards.forEach((card, k) => {
      const { value, interval, run, outside, far } = Surface.predict(responses[k], state.point);
      const range = ([low, high]) => shown(low) + " … " + shown(high);
      card.querySelector(".value").textContent = shown(value);
      card.querySelector(".interval").textContent = Number.isFinite(interval[0]) ? "mean within " + range(interval) + " (95 %)" : "interval unknown: the fit has no residual";
      card.querySelector(".run").textContent = Number.isFinite(run[0]) ? "a single run within " + range(run) : "";
      const beyond = outside.length ? ["extrapolated: ", ...joined(outside.map((i) => [sign.parameter(i)]), ", "), " outside what was run"] : far ? ["extrapolated: farther out than any run"] : [];
      card.querySelector(".mark").replaceChildren(...beyond);
      card.classList.toggle("beyond", beyond.length > 0);
    });
    const words = () => responses.map((surface) => surface.name + " = " + withUnit(shown(Surface.value(surface, state.point)), surface.unit)).join(", ");
    const showTexts = () => {
      find(".toml").textContent = Texts.toml(model, state.point, words());
      find(".pfc").textContent = Texts.pfc(model, state.point, words());
    };
    const readout = make("output", { class: "readout", "data-hint": "Values: point at a curve." });
    const say = (response, parameter, u) => {
      if (response === null) { readout.replaceChildren(); return; }
      const x = state.point.slice();
      x[parameter] = Box.natural(parameters[parameter], u);
      const { value, interval } = Surface.predict(responses[response], x), { unit } = parameters[parameter];
      const about = Number.isFinite(interval[0]) ? ` (${shown(interval[0])} … ${shown(interval[1])})` : "";
      readout.replaceChildren(sign.response(response), ` = ${withUnit(shown(value), responses[response].unit)}${about} at `, sign.parameter(parameter), ` = ${withUnit(shown(x[parameter]), unit)}`);
    };
    const charts = Charts.charts(model, find(".charts"), labels, (i, u) => move(i, Box.natural(parameters[i], u)), say);
    find(".charts").prepend(readout);
    const showPoint = () => { showKnobs(); showCards(); charts.update(state.point, aims()); showTexts(); };
    const forget = () => { state.found = null; find(".extents").replaceChildren(); find(".verdict").replaceChildren(); find(".other").disabled = true; };
    const move = (i, x) => { state.point[i] = enforce(i, x); showPoint(); };

    // What the targets come to.
    const showReaches = () => aimRows.forEach((row, k) => { row.querySelector(".reach").textContent = "can be " + shown(state.reaches[k][0]) + " … " + shown(state.reaches[k][1]); });
    const reachAnew = () => { state.reaches = Solve.reaches(model, state.point, state.held); showReaches(); };
    const verdict = (found) => {
      const lines = [], add = (...parts) => lines.push(parts);
      const out = found.aims.filter(({ response, low, high }) => { const [least, most] = state.reaches[response]; return least > high || most < low; });
      for (const { response, high } of out) {
        const [least, most] = state.reaches[response], { unit } = responses[response];
        add("The target of ", sign.response(response), ` is out of reach: ${least > high ? "at least " + withUnit(shown(least), unit) : "at most " + withUnit(shown(most), unit)} can be had by itself.`);
      }
      const missed = found.aims.filter((aim, k) => !Solve.within(model, aim, found.values[k]));
      if (found.isMet) add("All targets are met.");
      else if (!missed.length) add("All targets are met within their tolerance, not exactly.");
      else {
        if (!out.length) add("Each target can be met by itself, all together cannot.");
        const nearest = found.aims.map(({ response }, k) => [sign.response(response), ` = ${withUnit(shown(found.values[k]), responses[response].unit)}${Math.abs(found.deviations[k]) > 5e-4 ? " (" + (found.deviations[k] > 0 ? "+" : "") + shown(100 * found.deviations[k], 3) + " %)" : ""}`]);
        add("The nearest that can: ", ...joined(nearest, ", "), ".");
      }
      if (found.free > 0) add(`Not unique: ${found.free} direction${found.free > 1 ? "s" : ""} stay${found.free > 1 ? "" : "s"} free; this is the solution nearest the ${parameters.some((p) => p.preferred !== null) ? "preferred point" : "middle of the ranges"}.`);
      add("Misfit " + (found.misfit < 1e-12 ? "0" : found.misfit.toExponential(1)) + ".");
      return lines;
    };
    const extent = (i, known) => {
      const parameter = parameters[i], low = Box.unit(parameter, known.low), high = Box.unit(parameter, known.high), at = Box.unit(parameter, found().point[i]);
      const by = known.by.flatMap((k, n) => [n ? " and " : " by ", sign.response(k)]);
      const tied = known.word !== "held" && known.word !== "free" && known.word !== "unknown";
      const text = [known.word, ...(tied && !by.length ? [" by all targets together"] : by)];
      const svg = "http://www.w3.org/2000/svg", bar = document.createElementNS(svg, "svg");
      bar.setAttribute("viewBox", "0 0 200 14");
      bar.setAttribute("preserveAspectRatio", "none");
      bar.setAttribute("aria-hidden", "true");
      const rect = (x, width, name, y, height) => { const r = document.createElementNS(svg, "rect"); for (const [k, v] of Object.entries({ x, y, width, height, class: name })) r.setAttribute(k, v); bar.append(r); };
      rect(0, 200, "all", 5, 4);
      rect(200 * low, Math.max(200 * (high - low), 1), known.word === "free" ? "loose" : "tied", 2, 10);
      rect(200 * at - 1, 2, "here", 0, 14);
      const ends = known.word === "held" ? shown(found().point[i]) : shown(known.low) + " … " + shown(known.high);
      return make("div", { class: "extent", role: "listitem" }, make("span", { class: "head" }, sign.parameter(i)), bar, make("span", { class: "range" }, withUnit(ends, parameter.unit)), make("span", { class: "word" }, ...text));
    };
    const found = () => state.found;
    const showFound = () => {
      find(".verdict").replaceChildren(...verdict(state.found).map((line) => make("p", {}, ...line)));
      find(".verdict").classList.toggle("unmet", !state.found.isMet);
      find(".other").disabled = !state.found.others.length;
    };
    // The extents take longer than the solution: they come when that is on the screen.
    const determineLater = () => {
      const mine = state.found, list = find(".extents");
      const next = (i) => {
        if (state.found !== mine || i === parameters.length) return;
        list.append(extent(i, Solve.determine(model, mine, i)));
        setTimeout(next, 0, i + 1);
      };
      setTimeout(next, 30, 0);
    };
    const seek = () => {
      const list = aims(), wrong = all(".aim .low, .aim .high", root).find((field) => !field.hidden && field.getAttribute("aria-invalid") === "true");
      const fault = wrong ? [refused(wrong)] : faultOf(list);
      forget();
      if (fault) { find(".verdict").replaceChildren(make("p", {}, ...fault)); find(".verdict").classList.add("unmet"); charts.update(state.point, []); return; }
      const broken = Box.domain(model, state.point, state.held).broken;
      if (broken.length) { find(".verdict").replaceChildren(make("p", {}, "What is held breaks " + broken.map(({ text }) => text).join(", ") + ".")); return; }
      state.found = Solve.solve(model, list, state.point, state.held);
      state.other = -1;
      state.point = state.found.point.slice();
      showPoint();
      showFound();
      determineLater();
    };

    // What a person does.
    knobs.forEach((knob, i) => {
      knob.querySelector(".slide").addEventListener("input", (event) => move(i, Box.natural(parameters[i], Number(event.target.value))));
      const field = knob.querySelector(".value");
      const typed = () => {
        const x = read(field);
        if (Number.isFinite(x)) move(i, x);
        else if (field.value.trim() !== "") find(".said").replaceChildren(refused(field));
      };
      field.addEventListener("input", () => { const x = read(field); if (x >= parameters[i].low && x <= parameters[i].high) typed(); });
      field.addEventListener("change", () => {
        typed();
        field.value = Number(state.point[i].toPrecision(6));
        field.setAttribute("aria-invalid", "false");
      });
      knob.querySelector(".hold input").addEventListener("change", (event) => { state.held[i] = event.target.checked; reachAnew(); });
    });
    const set = find(".set");
    aimRows.forEach((row) => {
      for (const field of all("input, .mode", row)) field.addEventListener("change", () => { fitMode(row); if (set) set.value = ""; seek(); });
      row.addEventListener("keydown", (event) => { if (event.key === "Enter") seek(); });
    });
    if (set) set.addEventListener("change", () => { if (set.value !== "") { writeSet(model.sets[Number(set.value)]); reachAnew(); seek(); } });
    find(".solve").addEventListener("click", seek);
    find(".other").addEventListener("click", () => {
      state.other = (state.other + 1) % (state.found.others.length + 1);
      state.point = (state.found.others[state.other] ?? state.found.point).slice();
      showPoint();
    });
    for (const name of ["toml", "pfc"]) {
      const output = make("output");
      find("." + name).after(make("div", { class: "tools" }, copier("Copy", () => find("." + name).textContent, output), output));
    }

    state.point = parameters.map((parameter) => parameter.preferred ?? Box.natural(parameter, 0.5));
    state.held = parameters.map((parameter) => parameter.held);
    if (model.sets.length) writeSet(model.sets[0]);
    reachAnew();
    seek();
    return { model, state };
  };

  return { all: all(".calibrator").map(start) };
})();
