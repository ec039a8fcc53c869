(() => {
  const { make, all, copy, copier } = Page;

  // Contents: open where there is room, with the place of the reader.
  const contents = document.getElementById("contents");
  const wide = matchMedia("(min-width: 60.01rem)");
  const fit = () => { contents.open = wide.matches; };
  wide.addEventListener("change", fit);
  fit();
  const links = new Map(all("a", contents).map((a) => [a.getAttribute("href").slice(1), a]));
  const sections = all("main > section");
  const here = () => {
    let current = sections[0];
    for (const section of sections) if (section.getBoundingClientRect().top < innerHeight * 0.3) current = section;
    for (const [id, link] of links) {
      if (id === current.id) {
        if (!link.hasAttribute("aria-current")) {
          link.setAttribute("aria-current", "true");
          const box = contents.parentElement;
          if (wide.matches) box.scrollTop = link.offsetTop - box.clientHeight / 2;
        }
      } else link.removeAttribute("aria-current");
    }
  };
  let waiting = false;
  addEventListener("scroll", () => {
    if (!waiting) requestAnimationFrame(() => { waiting = false; here(); });
    waiting = true;
  }, { passive: true });
  here();

  // Tables: sort by a head, copy as TSV or CSV.
  const value = (cell) => cell.dataset.v ?? cell.textContent.trim().replaceAll("−", "-");
  const cells = (table) => [
    all("thead th", table).map((th) => th.dataset.k ?? th.dataset.text ?? th.textContent.trim()),
    ...all("tbody tr", table).map((tr) => [...tr.children].map(value)),
  ];
  const quoted = (text) => /[",\n\r]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
  const tsv = (table) => cells(table).map((row) => row.map((text) => text.replace(/[\t\n\r]+/g, " ")).join("\t")).join("\n") + "\n";
  const csv = (table) => cells(table).map((row) => row.map(quoted).join(",")).join("\n") + "\n";
  // For word processors: the heads as they are typeset, rules as in print, numbers as they are shown.
  const word = (table) => {
    const set = (cell) => {
      const copy = cell.cloneNode(true);
      for (const button of all("button", copy)) button.replaceWith(...button.childNodes);
      for (const bar of all(".bar", copy)) bar.replaceWith(make("span", { style: "text-decoration:overline" }, ...bar.childNodes));
      return copy.innerHTML;
    };
    const rule = { first: "border-top:1.5pt solid;border-bottom:.75pt solid;", last: "border-bottom:1.5pt solid;" };
    const row = (tr, style) => "<tr>" + [...tr.cells].map((cell) => {
      const tag = cell.tagName.toLowerCase(), align = cell.classList.contains("t") ? "left" : "right";
      return `<${tag} style="${style}text-align:${align};padding:1pt 6pt;font-weight:normal">${set(cell)}</${tag}>`;
    }).join("") + "</tr>";
    const rows = [...table.tBodies[0].rows];
    const body = rows.map((tr, i) => row(tr, i + 1 === rows.length ? rule.last : ""));
    return `<table style="border-collapse:collapse;font-family:'Times New Roman',serif;font-size:10pt"><caption style="text-align:left">${table.caption.querySelector("span").innerHTML}</caption><thead>${row(table.tHead.rows[0], rule.first)}</thead><tbody>${body.join("")}</tbody></table>`;
  };
  // LaTeX for booktabs.
  const latex = (table) => {
    const signs = { "\\": "\\textbackslash{}", "~": "\\textasciitilde{}", "^": "\\textasciicircum{}", "−": "$-$", "≈": "$\\approx$", "≠": "$\\neq$", "↑": "$\\uparrow$", "↓": "$\\downarrow$" };
    const plain = (text) => text.replace(/[\\&%$#_{}~^−≈≠↑↓]/g, (c) => signs[c] ?? "\\" + c);
    const [head, ...rows] = cells(table);
    const line = (row) => row.map(plain).join(" & ") + " \\\\";
    const form = [...table.tHead.rows[0].cells].map((th) => th.classList.contains("t") ? "l" : "r").join("");
    return ["\\begin{tabular}{" + form + "}", "\\toprule", line(head), "\\midrule", ...rows.map(line), "\\bottomrule", "\\end{tabular}"].join("\n") + "\n";
  };
  const sort = (table, place, head) => {
    const body = table.tBodies[0];
    const up = head.getAttribute("aria-sort") !== "ascending";
    const key = (row) => {
      const text = value(row.children[place]);
      return { text, number: text === "" ? NaN : Number(text), empty: text === "" };
    };
    const rows = [...body.rows].map((row) => ({ row, key: key(row) }));
    const numeric = rows.every(({ key }) => key.empty || !Number.isNaN(key.number));
    rows.sort((a, b) => {
      if (a.key.empty !== b.key.empty) return a.key.empty ? 1 : -1;
      const order = numeric ? a.key.number - b.key.number : a.key.text.localeCompare(b.key.text, "en", { numeric: true });
      return (up ? order : -order) || 0;
    });
    body.append(...rows.map(({ row }) => row));
    for (const th of all("thead th", table)) th.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", up ? "ascending" : "descending");
  };
  for (const sheet of all(".sheet")) {
    const table = sheet.querySelector("table");
    all("thead th", table).forEach((th, place) => {
      th.dataset.text = th.textContent.trim();
      th.setAttribute("aria-sort", "none");
      th.append(make("button", { type: "button", onclick: () => sort(table, place, th) }, ...th.childNodes));
    });
    const output = make("output");
    const name = table.caption.textContent.trim();
    const tools = make("div", { class: "tools", role: "group", "aria-label": "Table " + name },
      copier("Copy", () => tsv(table), output), copier("Copy as CSV", () => csv(table), output),
      copier("Copy for Word", () => tsv(table), output, () => word(table)), copier("Copy as LaTeX", () => latex(table), output), output);
    sheet.after(tools);
    sheet.setAttribute("role", "region");
    sheet.setAttribute("aria-label", name);
    sheet.tabIndex = 0;
  }

  // Figures: values under the pointer or the arrow keys.
  const SVG = "http://www.w3.org/2000/svg";
  const draw = (tag, more) => {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(more)) element.setAttribute(name, value);
    return element;
  };
  // Words with the symbols of the workflow as they are set. The markup of a symbol is the page's own.
  const symbols = new Map(JSON.parse(document.getElementById("symbols").textContent).map(([plain, markup]) => {
    const template = make("template");
    template.innerHTML = markup;
    return [plain, template.content];
  }));
  const sign = (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
  const seek = symbols.size && new RegExp("(?<![\\p{L}\\p{N}_\\p{M}])(" + [...symbols.keys()].map(sign).join("|") + ")(?![\\p{L}\\p{N}_\\p{M}])", "u");
  const typeset = (words) => !seek ? [words] : words.split(seek).map((part, i) => i % 2 ? symbols.get(part).cloneNode(true) : part);
  const told = (number, digits = 4) => {
    if (number === null || !Number.isFinite(number)) return "–";
    const size = Math.abs(number);
    const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? number.toExponential(digits - 1) : String(Number(number.toPrecision(digits)));
    return text.replaceAll("-", "−");
  };
  const quantity = (axis, number) => axis.name + " = " + told(number) + (axis.unit ? " " + axis.unit : "");
  const scale = (fact) => {
    const [low, high, from, to, form] = fact.split(" ");
    const map = form === "log" ? Math.log : (x) => x, back = form === "log" ? Math.exp : (x) => x;
    const a = map(+low), b = map(+high), p = +from, q = +to;
    return { at: (v) => p + (map(v) - a) / (b - a) * (q - p), value: (s) => back(a + (s - p) / (q - p) * (b - a)),
             holds: (s) => s >= Math.min(p, q) - 1 && s <= Math.max(p, q) + 1 };
  };
  const panels = (svg) => all("g[data-x]", svg).map((g) => ({ x: scale(g.dataset.x), y: scale(g.dataset.y) }));
  const inside = (found, at) => found.findIndex((p) => p.x.holds(at[0]) && p.y.holds(at[1]));

  // Each form answers with the marks and words of a place (`near`), and of a step by keys (`step`).
  const curve = (svg, data) => {
    const found = panels(svg);
    const say = (k, i) => {
      const c = data.curves[k];
      const marks = [[found[0].x.at(c.strain[i]), found[0].y.at(c.stress[i])]];
      if (c.lateral) marks.push([found[0].x.at(c.lateral[i]), found[0].y.at(c.stress[i])]);
      if (found[1]) for (const mode of c.cracks) marks.push([found[1].x.at(c.strain[i]), found[1].y.at(mode.values[i])]);
      const words = [c.name, "axial strain " + told(c.strain[i], 3) + " %", "stress " + told(c.stress[i]) + " MPa"];
      if (c.lateral) words.push("lateral strain " + told(c.lateral[i], 3) + " %");
      if (c.cracks.length) words.push("cracks: " + c.cracks.map((mode) => told(mode.values[i]) + " " + mode.name).join(", "));
      return { marks, words: words.filter(Boolean).join(", "), line: marks[0][0], state: [k, i] };
    };
    const near = (at) => {
      const p = inside(found, at);
      if (p < 0) return null;
      let best = null;
      data.curves.forEach((c, k) => c.strain.forEach((strain, i) => {
        if (strain === null || c.stress[i] === null) return;
        const places = p === 0
          ? [[strain, c.stress[i]], ...(c.lateral && c.lateral[i] !== null ? [[c.lateral[i], c.stress[i]]] : [])]
          : c.cracks.map((mode) => [strain, mode.values[i]]);
        for (const [x, y] of places) {
          // Along one curve the strain counts; among several the distance.
          const dx = found[p].x.at(x) - at[0], dy = data.curves.length > 1 ? found[p].y.at(y) - at[1] : 0;
          const d = dx * dx + dy * dy;
          if (!best || d < best.d) best = { d, k, i };
        }
      }));
      return best && say(best.k, best.i);
    };
    const step = (state, dx, dy) => {
      if (!state) {
        const c = data.curves[0];
        return say(0, c.stress.reduce((best, s, i) => (s ?? -Infinity) > (c.stress[best] ?? -Infinity) ? i : best, 0));
      }
      const k = (state[0] + dy + data.curves.length) % data.curves.length;
      return say(k, Math.min(Math.max(state[1] + dx, 0), data.curves[k].strain.length - 1));
    };
    return { near, step };
  };

  const points = (svg, data) => {
    const found = panels(svg);
    const say = (p, i) => {
      const list = data.panels[p];
      const mark = [found[p].x.at(list.x[i]), found[p].y.at(list.y[i])];
      return { marks: [mark], words: list.words[i], state: [p, i] };
    };
    const near = (at) => {
      const p = inside(found, at);
      if (p < 0 || !data.panels[p]) return null;
      let best = null;
      data.panels[p].x.forEach((x, i) => {
        const d = Math.hypot(found[p].x.at(x) - at[0], found[p].y.at(data.panels[p].y[i]) - at[1]);
        if (!best || d < best.d) best = { d, i };
      });
      return best && (data.cells || best.d < 8) ? say(p, best.i) : null;
    };
    const step = (state, dx, dy) => {
      if (!state) return say(0, 0);
      const p = Math.min(Math.max(state[0] + Math.sign(dy), 0), Math.min(found.length, data.panels.length) - 1);
      const count = data.panels[p].x.length;
      // From left to right, whatever the order of the runs.
      const order = data.panels[p].x.map((x, i) => [x, i]).sort((a, b) => a[0] - b[0] || a[1] - b[1]).map(([, i]) => i);
      const place = p === state[0] ? order.indexOf(state[1]) + dx : 0;
      return say(p, order[Math.min(Math.max(place, 0), count - 1)]);
    };
    return { near, step };
  };

  const field = (svg, data) => {
    const { x, y, z } = data;
    // Parabolas through the three nodes around a place, along each side: exact for second-order surfaces.
    const weights = (axis, v) => {
      const [low, high] = axis.ends, n = axis.count;
      const s = Math.min(Math.max((v - low) / (high - low) * (n - 1), 0), n - 1);
      const i = Math.min(Math.max(Math.round(s) - 1, 0), n - 3), t = s - i;
      return [i, [(t - 1) * (t - 2) / 2, t * (2 - t), t * (t - 1) / 2]];
    };
    const at = (u, v) => {
      const [i, a] = weights(x, u), [j, b] = weights(y, v);
      let sum = 0;
      for (let k = 0; k < 3; k++) for (let l = 0; l < 3; l++) sum += a[k] * b[l] * z.values[(j + l) * x.count + i + k];
      return sum;
    };
    const flat = panels(svg)[0];
    const solid = svg.querySelector("g[data-space]");
    let place, back;
    if (solid) {
      const f = solid.dataset.space.split(" ").map(Number);
      const [x0, x1, y0, y1, z0, z1, ox, oy, ax, ay, bx, by, cx, cy] = f;
      place = (u, v, w) => {
        const r = (u - x0) / (x1 - x0), s = (v - y0) / (y1 - y0), t = (w - z0) / (z1 - z0);
        return [ox + r * (ax - ox) + s * (bx - ox) + t * (cx - ox), oy + r * (ay - oy) + s * (by - oy) + t * (cy - oy)];
      };
      back = ([px, py]) => {
        // The nearest of a fine net of places on the surface; of those that coincide, the one in front.
        const net = 60;
        let best = null;
        for (let j = 0; j <= net; j++) for (let i = 0; i <= net; i++) {
          const u = x.ends[0] + i / net * (x.ends[1] - x.ends[0]), v = y.ends[0] + j / net * (y.ends[1] - y.ends[0]);
          const [qx, qy] = place(u, v, at(u, v));
          const d = Math.hypot(qx - px, qy - py) + 0.004 * (j - i);
          if (!best || d < best.d) best = { d, u, v };
        }
        return best.d < 3 ? [best.u, best.v] : null;
      };
    } else if (flat) {
      place = (u, v) => [flat.x.at(u), flat.y.at(v)];
      back = ([px, py]) => flat.x.holds(px) && flat.y.holds(py) ? [flat.x.value(px), flat.y.value(py)] : null;
    } else return null;
    const clamp = (axis, v) => Math.min(Math.max(v, axis.ends[0]), axis.ends[1]);
    const say = (u0, v0) => {
      const u = clamp(x, u0), v = clamp(y, v0), w = at(u, v);
      const words = [quantity(z, w), "at " + quantity(x, u), quantity(y, v)].join(", ");
      return { marks: [place(u, v, w)], words, state: [u, v] };
    };
    const near = (p) => { const found = back(p); return found && say(...found); };
    const step = (state, dx, dy) => {
      const [u, v] = state ?? [(x.ends[0] + x.ends[1]) / 2, (y.ends[0] + y.ends[1]) / 2];
      return say(u + dx * (x.ends[1] - x.ends[0]) / 50, v + (state ? -dy : 0) * (y.ends[1] - y.ends[0]) / 50);
    };
    return { near, step };
  };

  const forms = { curve, points, field };
  const bring = (plot, data, readout) => {
    const svg = plot.querySelector("svg");
    const teller = forms[data.form]?.(svg, data);
    if (!teller) return false;
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const layer = draw("g", { class: "cursor", "aria-hidden": "true" });
    svg.append(layer);
    let state = null;
    const show = (found) => {
      layer.replaceChildren();
      readout.replaceChildren(...(found ? typeset(found.words) : []));
      if (!found) return;
      state = found.state;
      if (found.line !== undefined) layer.append(draw("line", { x1: found.line, x2: found.line, y1: 0, y2: height }));
      for (const [cx, cy] of found.marks) if (Number.isFinite(cx) && Number.isFinite(cy)) layer.append(draw("circle", { cx, cy, r: 1.1 }));
    };
    const move = (event) => {
      const box = svg.getBoundingClientRect();
      show(teller.near([(event.clientX - box.left) / box.width * width, (event.clientY - box.top) / box.height * height]));
    };
    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerleave", () => { if (document.activeElement !== plot) show(null); });
    const keys = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    plot.addEventListener("keydown", (event) => {
      const [dx, dy] = keys[event.key] ?? [];
      if (dx === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const far = event.shiftKey ? 10 : 1;
      show(teller.step(state, dx * far, dy));
    });
    plot.addEventListener("focus", () => { if (plot.matches(":focus-visible")) show(teller.step(state, 0, 0)); });
    plot.addEventListener("blur", () => show(null));
    return true;
  };

  // Zoom: a dialog with the picture as large as there is room, or larger.
  const dialog = document.getElementById("zoom");
  const zoom = (figure, data) => {
    const plot = figure.querySelector(".plot").cloneNode(true);
    for (const layer of all(".cursor", plot)) layer.remove();
    plot.removeAttribute("role");
    const picture = plot.querySelector("svg, img");
    const box = make("div", { class: "stage-box", tabindex: "0", role: "region", "aria-label": "Picture" }, plot);
    const readout = make("output", { class: "readout" });
    let size = 1;
    const set = (to) => {
      size = Math.min(Math.max(to, 1), 12);
      const ratio = picture.viewBox ? picture.viewBox.baseVal.width / picture.viewBox.baseVal.height : picture.width / picture.height;
      const pad = 2 * 0.7 * 16 + 24;
      const fit = Math.min(box.clientWidth - pad, (box.clientHeight - pad) * ratio);
      plot.style.width = Math.max(fit, 160) * size + pad / 2 + "px";
      picture.style.maxWidth = "none";
      picture.style.width = "100%";
    };
    const button = (name, label, what) => make("button", { type: "button", "aria-label": label, onclick: what }, name);
    const title = [...figure.querySelector("figcaption").cloneNode(true).childNodes];
    dialog.replaceChildren(
      make("div", { class: "head" }, make("p", {}, ...title), button("−", "Smaller", () => set(size / 1.5)),
        button("+", "Larger", () => set(size * 1.5)), button("Fit", "Fit the window", () => set(1)), button("Close", "Close", () => dialog.close())),
      box, readout);
    dialog.showModal();
    set(1);
    if (data && picture.tagName === "svg") {
      plot.tabIndex = 0;
      if (bring(plot, data, readout)) readout.dataset.hint = "Values: point at the picture, or use the arrow keys.";
    }
    box.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      set(size * (event.deltaY < 0 ? 1.15 : 1 / 1.15));
    }, { passive: false });
    dialog.onkeydown = (event) => {
      if (event.key === "+" || event.key === "=") set(size * 1.5);
      else if (event.key === "-") set(size / 1.5);
      else if (event.key === "0") set(1);
    };
    dialog.onclick = (event) => { if (event.target === dialog) dialog.close(); };
  };
  dialog.addEventListener("close", () => dialog.replaceChildren());

  const table = (data) => {
    const cell = (v) => v === null || v === undefined ? "" : String(v);
    const lines = [];
    if (data.form === "curve") {
      for (const c of data.curves) {
        lines.push(["axial strain [%]", "stress [MPa]", ...(c.lateral ? ["lateral strain [%]"] : []), ...c.cracks.map((m) => "cracks " + m.name)]);
        c.strain.forEach((s, i) => lines.push([s, c.stress[i], ...(c.lateral ? [c.lateral[i]] : []), ...c.cracks.map((m) => m.values[i])]));
      }
    } else if (data.form === "field") {
      const node = (axis, i) => axis.ends[0] + i / (axis.count - 1) * (axis.ends[1] - axis.ends[0]);
      lines.push([data.x, data.y, data.z].map((a) => a.name + (a.unit ? " [" + a.unit + "]" : "")));
      data.z.values.forEach((v, k) => lines.push([node(data.x, k % data.x.count), node(data.y, Math.floor(k / data.x.count)), v]));
    } else {
      lines.push(["panel", "x", "y", "what"]);
      data.panels.forEach((p, k) => p.x.forEach((x, i) => lines.push([k + 1, x, p.y[i], p.words[i]])));
    }
    return lines.map((line) => line.map(cell).join("\t")).join("\n") + "\n";
  };
  for (const figure of all("figure")) {
    const plot = figure.querySelector(".plot");
    const script = figure.querySelector("script.values");
    let data = null;
    try { data = script && JSON.parse(script.textContent); } catch { /* a picture without values */ }
    const name = figure.querySelector("figcaption b").textContent;
    const output = make("output");
    const tools = make("div", { class: "tools", role: "group", "aria-label": name },
      make("button", { type: "button", onclick: () => zoom(figure, data) }, "Enlarge"));
    if (data) {
      const readout = make("output", { class: "readout", "data-hint": "Values: point at the picture, or focus it and use the arrow keys." });
      if (bring(plot, data, readout)) {
        plot.tabIndex = 0;
        plot.setAttribute("role", "group");
        plot.setAttribute("aria-label", name + ": values by the arrow keys");
        plot.after(readout);
        tools.append(copier("Copy values", () => table(data), output));
      }
    }
    tools.append(output);
    figure.append(tools);
    plot.addEventListener("click", () => { if (!String(getSelection())) zoom(figure, data); });
  }
})();
