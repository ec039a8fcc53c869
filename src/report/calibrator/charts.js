// What-if curves: one small chart for each response and each parameter that it depends on.
const Charts = (() => {
  const SVG = "http://www.w3.org/2000/svg", WIDTH = 210, HEIGHT = 130, LEFT = 38, RIGHT = 8, TOP = 8, BOTTOM = 20, STEPS = 40;
  const draw = (tag, more, text) => {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(more)) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  // About `count` round numbers between two ends.
  const ticks = (low, high, count) => {
    const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough) ?? 10 * power;
    const found = [];
    for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(Number((i * step).toPrecision(12)));
    return found;
  };
  const shown = (x, digits = 4) => String(Number(x.toPrecision(digits))).replaceAll("-", "−");

  // The curve of a response over one parameter.
  const sweep = (model, response, parameter, point) => Array.from({ length: STEPS + 1 }, (_, i) => {
    const x = point.slice();
    x[parameter] = Box.natural(model.parameters[parameter], i / STEPS);
    const { value, interval } = Surface.predict(model.responses[response], x);
    return { u: i / STEPS, value, interval };
  });

  const path = (places) => places.map(([x, y], i) => (i ? "L" : "M") + x.toFixed(1) + " " + y.toFixed(1)).join("");

  // `cells` are the charts with the parts that change; `update` draws the curves of a point anew.
  const charts = (model, root, labels, go, say) => {
    const rows = model.responses.map((surface, response) => {
      const own = surface.axes.map(({ parameter }) => parameter);
      const row = document.createElement("div");
      row.className = "row";
      const head = document.createElement("h4");
      head.append(labels.response(response));
      const grid = document.createElement("div");
      grid.className = "grid";
      row.append(head, grid);
      root.append(row);
      const cells = own.map((parameter) => {
        const figure = document.createElement("figure"), caption = document.createElement("figcaption");
        const svg = draw("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
        caption.append(labels.parameter(parameter));
        figure.append(svg, caption);
        grid.append(figure);
        const place = (event) => {
          const box = svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width * WIDTH;
          return Math.min(Math.max((x - LEFT) / (WIDTH - LEFT - RIGHT), 0), 1);
        };
        svg.addEventListener("pointermove", (event) => say(response, parameter, place(event)));
        svg.addEventListener("pointerleave", () => say(null));
        svg.addEventListener("click", (event) => go(parameter, place(event)));
        return { parameter, svg };
      });
      return { response, cells };
    });

    const one = (cell, curve, [low, high], surface, point, aim, drawn) => {
      const parameter = model.parameters[cell.parameter];
      const X = (u) => LEFT + u * (WIDTH - LEFT - RIGHT), Y = (v) => HEIGHT - BOTTOM - (v - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
      const parts = [];
      for (const v of ticks(low, high, 4)) parts.push(draw("line", { class: "rule", x1: LEFT, x2: WIDTH - RIGHT, y1: Y(v), y2: Y(v) }), draw("text", { x: LEFT - 4, y: Y(v) + 3.5, "text-anchor": "end" }, shown(v)));
      for (const x of parameter.log ? [parameter.low, parameter.high] : ticks(parameter.low, parameter.high, 4)) parts.push(draw("text", { x: X(Box.unit(parameter, x)), y: HEIGHT - 6, "text-anchor": "middle" }, shown(x)));
      if (Number.isFinite(curve[0].interval[0])) parts.push(draw("path", { class: "band", d: path([...curve.map(({ u, interval }) => [X(u), Y(interval[1])]), ...curve.slice().reverse().map(({ u, interval }) => [X(u), Y(interval[0])])]) + "Z" }));
      for (const end of aim ? [...new Set([aim.low, aim.high])].filter(Number.isFinite) : []) if (end >= low && end <= high) parts.push(draw("line", { class: "goal", x1: LEFT, x2: WIDTH - RIGHT, y1: Y(end), y2: Y(end) }));
      const at = Box.unit(parameter, point[cell.parameter]), here = Surface.value(surface, point);
      parts.push(draw("path", { class: "line", d: path(curve.map(({ u, value }) => [X(u), Y(value)])) }), draw("circle", { cx: X(at), cy: Y(here), r: 4 }));
      cell.svg.replaceChildren(...parts);
      cell.svg.setAttribute("aria-label", `${surface.name} over ${parameter.name}: ${shown(curve[0].value)} at ${shown(parameter.low)}, ${shown(here)} here, ${shown(curve[STEPS].value)} at ${shown(parameter.high)} ${drawn}`);
    };

    const update = (point, aims) => {
      for (const { response, cells } of rows) {
        const surface = model.responses[response], aim = aims.find((own) => own.response === response);
        const curves = cells.map(({ parameter }) => sweep(model, response, parameter, point));
        const all = curves.flat().flatMap(({ value, interval }) => [value, ...interval]).concat(aim ? [aim.low, aim.high] : []).filter(Number.isFinite);
        let [low, high] = [Math.min(...all), Math.max(...all)];
        const margin = (high - low || Math.abs(high) || 1) * 0.05;
        [low, high] = [low - margin, high + margin];
        cells.forEach((cell, k) => one(cell, curves[k], [low, high], surface, point, aim, surface.unit));
      }
    };
    return { update };
  };
  return { charts, shown };
})();
